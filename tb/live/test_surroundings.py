# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""`make serve` in surroundings that lack something: disk, a HOME, the right to write; and several starts at once."""

import json
import os
import shutil
import subprocess
import sys

import pytest
from protocol import frames
from protocol.defs import FC

from live.serve import ROOT, Port, Serve, command, request

READ = request(frames.read(FC.READ_HOLDINGS, 0, 1))
TOOL = [sys.executable, str(ROOT / "sim" / "serve.py")]
NOBODY = 65534


def run(arguments, environment, prefix=()):
    """(exit status, lines of standard error) of serve.py that must not start."""
    done = subprocess.run(
        [*prefix, *TOOL, *arguments], cwd=ROOT, env=os.environ | environment, capture_output=True, text=True,
        timeout=240, check=False,
    )  # fmt: skip
    assert "ready" not in done.stdout
    return done.returncode, done.stderr.splitlines()


def separate():
    """A command prefix for a mount name space of one's own, or a skip."""
    prefix = ["unshare", "--mount", "--map-root-user"] if os.geteuid() else ["unshare", "--mount"]
    if not shutil.which("unshare") or subprocess.run([*prefix, "true"], capture_output=True, check=False).returncode:
        pytest.skip("no mount name space of one's own")
    return prefix


def test_full_disk_is_said(tmp_path):
    """Not that the device does not compile, but why."""
    place = tmp_path / "small"
    place.mkdir()
    inside = f'mount -t tmpfs -o size=200k small {place} && exec "$@"'
    prefix = [*separate(), "sh", "-c", inside, "sh"]
    if subprocess.run([*prefix, "true"], capture_output=True, check=False).returncode:
        pytest.skip("no mount")
    status, lines = run([f"LINK={tmp_path / 'x'}"], {"BENCH_BUILD": str(place)}, prefix)
    assert status == 1 and f"no space left in {place}" in lines[-1], lines
    assert len(lines) <= 2, lines


def test_compiler_cache_without_a_home(tmp_path):
    """g++ may be ccache, which needs a folder it may write."""
    ccache = shutil.which("ccache")
    if not ccache:
        pytest.skip("ccache is not installed")
    (tmp_path / "g++").symlink_to(ccache)
    environment = {
        "PATH": f"{tmp_path}:{os.environ['PATH']}",
        "HOME": "/proc/none",
        "BENCH_BUILD": str(tmp_path / "build"),
    }
    keep = {k: v for k, v in os.environ.items() if not k.startswith(("CCACHE", "XDG"))}
    program = f"""
import sys; sys.path[:0] = [{str(ROOT / "tools")!r}]
import models, pathlib
place = pathlib.Path({str(tmp_path)!r})
print(models._run(["g++", "-c", "-x", "c++", "/dev/null", "-o", str(place / "x.o")], place))
"""
    done = subprocess.run(
        [sys.executable, "-c", program], env=keep | environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "x.o").exists()


def test_built_checkout_that_may_only_be_read(tmp_path):
    """It serves, with a LINK elsewhere."""
    with Serve(tmp_path / "first") as running, Port(running.link) as port:  # now it is built
        assert port.ask(READ, bytes(7))
    place = tmp_path / "bus"
    inside = f'mount --bind {ROOT} {ROOT} && mount -o remount,ro,bind {ROOT} && cd {ROOT} && exec "$@"'
    prefix = [*separate(), "sh", "-c", inside, "sh"]
    if subprocess.run([*prefix, "true"], capture_output=True, check=False).returncode:
        pytest.skip("no mount")
    argv, environment = command(LINK=place)
    with open(tmp_path / "err", "w", encoding="utf-8") as err:
        process = subprocess.Popen([*prefix, *argv], env=environment, stdout=subprocess.PIPE, stderr=err, text=True)
    try:
        first = process.stdout.readline()
        said = (tmp_path / "err").read_text(encoding="utf-8")
        assert first == f"ready {place}\n", (first, said)
        with Port(place) as port:
            assert port.ask(READ, bytes(7))
        assert said == "", said
    finally:
        process.terminate()
        process.wait(10)
        process.stdout.close()
    process = subprocess.run(
        [*prefix, *command(LINK=place, MAP="coils=0+77")[0]], env=environment, capture_output=True, text=True,
        check=False, timeout=60,
    )  # fmt: skip
    lines = [line for line in process.stderr.splitlines() if not line.startswith("make")]
    assert process.returncode and "Read-only file system" in lines[-1] and len(lines) == 1, lines


def test_starts_at_once_say_nothing_but_ready(tmp_path):
    """No word of another make on standard output."""
    started = []
    for n in range(6):
        argv, environment = command(LINK=tmp_path / f"bus{n}")
        started.append(subprocess.Popen(argv, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True))
    try:
        for n, process in enumerate(started):
            assert process.stdout.readline() == f"ready {tmp_path / f'bus{n}'}\n"
    finally:
        for process in started:
            process.terminate()
            process.wait(10)
            process.stdout.close()


@pytest.mark.parametrize("objects,conformity,wanted", [
    ({"4": "Meter"}, None, 130), ({"0x80": "serial"}, None, 131), ({"4": "Meter", "128": "s"}, 2, 3),
    ({"3": "x"}, 1, 2),
    ({"0": "Acme"}, None, None), ({"4": "Meter"}, 130, None), ({"128": "s"}, 131, None), ({"4": ""}, None, None),
])  # fmt: skip
def test_objects_that_no_master_sees_are_told(tmp_path, monkeypatch, objects, conformity, wanted):
    monkeypatch.syspath_prepend(str(ROOT / "sim"))
    import init_file

    document = {"device_id": objects} | ({"conformity": conformity} if conformity else {})
    path = tmp_path / "init.json"
    path.write_text(json.dumps(document), encoding="utf-8")
    layout = init_file.Layout({name: range(8) for name in init_file.TABLES})
    warnings = init_file.load(path, layout).warnings
    assert [f'"conformity": {wanted}' in text for text in warnings] == ([True] if wanted else [])
    sys.modules.pop("init_file")
