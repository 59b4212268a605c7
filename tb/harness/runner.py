# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Builds the RTL and runs cocotb modules on it, for pytest.

Environment: WAVES=1 keeps a trace (dump.fst in the build folder), TREE=folder takes rtl/ and
examples/ from a copy (the mistakes do), CASE=regular expression runs only the cocotb tests whose name matches.
"""

import contextlib
import fcntl
import hashlib
import json
import os
import resource
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import cocotb_tools.config
import cocotb_tools.runner
import filelist
import models
import pytest
from cocotb_tools.runner import get_runner

from . import netlist as gates
from .build import for_simulator
from .volume import QUICK

ROOT = Path(__file__).resolve().parents[2]
TB = ROOT / "tb"
PRODUCTS = Path(os.environ.get("BENCH_BUILD", ROOT / "build" / "tb"))
TREE = Path(os.environ.get("TREE", ROOT))  # rtl/ and examples/ are here
# benches in Verilog that put modules together
EXTRA_SOURCES = [TB / "line", TB / "examples", TB / "bus", TB / "multidrop"]
# What tests look at below the top: (module, name). Verilator shows them nothing else there, but for WAVES=1.
INSIDE = (
    ("modbus_diagnostics", "memory"),
    ("modbus_health_ram", "memory"),
    ("slave_bench", "wb_cyc"),
    ("modbus_board", "*seconds_q"),
)
# pytest's rewriting of assertions takes a second a simulation; COCOTB_REWRITE_ASSERTION_FILES="*.py" brings it back.
REWRITE = "COCOTB_REWRITE_ASSERTION_FILES"
PLAIN_ASSERTIONS = {REWRITE: os.environ.get(REWRITE, "")}
BOARD_TOP = "_top"  # how the tops of constraints/ end
VERILATOR_MINIMUM = (5, 36)  # what cocotb 2 needs


def sources():
    """(Verilog files, include folders) of the core, the examples and the benches around the core."""
    files, folders = filelist.read(TREE, *filelist.ALL)
    benches = TB / "harness"  # around the core, with every field of its vectors on a port of its own
    return [TREE / name for name in files] + sorted(benches.glob("*.v")), [TREE / name for name in folders] + [benches]


def source_of(name):
    """Path of the file that holds a module, or of the file of this name."""
    files, folders = sources()
    files += [path for folder in folders for path in folder.glob("*.vh")]
    return next(path for path in files if name in (path.stem, path.name))


def fresh_verilator():
    """Path of a Verilator new enough for cocotb, or None: beside this Python, or on PATH."""
    for place in (Path(sys.executable).parent / "fronts", Path(sys.executable).parent, None):
        found = shutil.which("verilator", path=place and str(place))
        if not found:
            continue
        said = subprocess.run([found, "--version"], capture_output=True, text=True, check=False)
        words = said.stdout.split()
        if len(words) > 1 and tuple(int(n) for n in words[1].split(".")[:2]) >= VERILATOR_MINIMUM:
            return found
    return None


@contextlib.contextmanager
def same_environment():
    """What changes os.environ inside is undone: a later test finds the tools that it would find alone."""
    before = dict(os.environ)
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)


def simulator(name):
    """Make simulator `name` usable, or skip the test with the reason; changes PATH."""
    if name == "icarus" and not shutil.which("iverilog"):
        pytest.skip("Icarus Verilog (iverilog) is not installed")
    if name == "verilator":
        found = fresh_verilator()
        if not found:
            pytest.skip("no Verilator 5.036 or newer, which cocotb 2 needs")
        os.environ["PATH"] = f"{Path(found).parent}{os.pathsep}{os.environ['PATH']}"
        if os.environ.get("WAVES") != "1":
            return Compiled()
        if shutil.which("ccache"):
            os.environ.setdefault("OBJCACHE", "ccache")
    return get_runner(name)


@contextlib.contextmanager
def locked(folder):
    """Only one process at a time builds in `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


class Compiled(cocotb_tools.runner.Verilator):
    """cocotb's runner for Verilator with a `build` that takes a sixth of the time: by tools/models.py, once for the
    same contents. Tests see the ports and wires of the top, and what INSIDE lists; there are no waves."""

    def build(self, sources, hdl_toplevel, build_dir, includes=(), parameters=None, **_):
        libraries = cocotb_tools.config.libs_dir
        model = models.Model(
            hdl_toplevel,
            TB / "harness" / "main.cpp",
            [Path(source) for source in sources],
            [Path(folder) for folder in includes],
            parameters or {},
            shared=False,
            optimise=QUICK,  # with FULL=1 too: most of a run is Python's
            prefix="Vtop",
            inside=INSIDE,
            vpi=("-rdynamic", f"-Wl,-rpath,{libraries}", f"-L{libraries}", "-lcocotbvpi_verilator"),
            verilator=fresh_verilator(),
        )
        link = Path(build_dir) / hdl_toplevel  # where `test` looks for it
        program = models.compiled(model)
        link.parent.mkdir(parents=True, exist_ok=True)
        fresh = link.with_name(f"{link.name}.{os.getpid()}")
        fresh.symlink_to(program)
        os.replace(fresh, link)  # perhaps another starts it just now
        self._sources, self._verilog_sources, self._vhdl_sources = [], list(sources), []  # `test` asks for them

    def test(self, test_module, **settings):
        modules = [test_module] if isinstance(test_module, str) else test_module
        return super().test(test_module=["harness.own_clock", *modules], **settings)


def quicker():
    """cocotb's `get_runner` gives Compiled for Verilator from now on."""
    others = cocotb_tools.runner.get_runner
    cocotb_tools.runner.get_runner = lambda name: Compiled() if name == "verilator" else others(name)


def build(sim, top, parameters, own="", netlist=False, made=None):
    """Compile `top`, or the iCE40 netlist of it; returns (runner, folder).

    `made` is a Verilog file that another tool has made of `top`, with the parameters frozen in it.

    Verilator's builds are shared by all that want the same; Icarus builds, which take no time,
    are kept apart by `own`, so that tests run beside each other. In Verilator tests see the ports and wires of
    `top` alone, but for WAVES=1.
    """
    runner = simulator(sim)
    files, folders = sources()
    files += sorted(p for f in EXTRA_SOURCES for p in f.glob("*.v"))
    if top.endswith(BOARD_TOP):
        files += sorted((ROOT / "constraints").glob("*/*.v"))
    waves = os.environ.get("WAVES") == "1"
    kind = ["netlist"] if netlist else [made.read_text(encoding="utf-8")] if made else []
    key = json.dumps([str(TREE), parameters, waves, *kind], sort_keys=True)
    name = f"{sim}_{own or top}" if sim == "icarus" else f"{sim}_{top}"
    folder = PRODUCTS / f"{name}_{hashlib.sha1(key.encode()).hexdigest()[:8]}"
    arguments = {
        "icarus": ["-Wall", *([] if waves else ["-g2005"])],
        "verilator": ["-Wno-fatal", "--x-assign", "fast", "--x-initial", "fast"],
    }[sim]
    defines = {}
    if made:
        files, parameters = [*files, made], {}
    if netlist:
        rtl = sources()
        place = gates.folder(top, parameters, *rtl, PRODUCTS)
        with locked(place):
            made = gates.netlist(place, top, parameters, *rtl)
        files, folders, parameters, defines = [made, gates.cells()], [], {}, gates.DEFINES
    with locked(folder):
        runner.build(
            sources=files,
            includes=folders,
            defines=defines,
            hdl_toplevel=top,
            build_dir=folder,
            parameters=for_simulator(sim, parameters),
            timescale=("1ns", "1ps"),
            always=sim == "icarus",
            build_args=arguments,
            waves=waves,
            log_file=folder / "build.log",
        )
    return runner, folder


def results(xml):
    """[(cocotb test, passed), ...] of a results file; a test that a build skips did not run."""
    out = []
    for case in ET.parse(xml).iter("testcase"):
        if case.find("skipped") is not None:
            continue
        bad = case.find("failure") is not None or case.find("error") is not None
        out.append((f"{case.get('classname')}.{case.get('name')}", not bad))
    return out


def run(record_property, sim, top, modules, parameters=None, env=None, only=None, own="", netlist=False, made=None):
    """Build `top` and run the cocotb `modules` (a name or several) in it; fails if one test fails.

    With `netlist` it is the gates that Yosys makes of `top`, of which only the ports have names; with `made` it is
    that Verilog file, which another tool has made.
    `only`, a regular expression, chooses among the cocotb tests; CASE from outside goes before it.
    `own` names the folder of a run that may go beside others of the same build.
    Every cocotb test is handed to the closing count by `record_property`.
    """
    with same_environment():
        _run(record_property, sim, top, modules, parameters or {}, env, only, own, netlist, made)


def _run(record_property, sim, top, modules, parameters, env, only, own, netlist, made):
    modules = [modules] if isinstance(modules, str) else list(modules)
    runner, folder = build(sim, top, parameters, own, netlist, made)
    extra = {
        "BENCH_TOP": top,
        "BENCH_PARAMETERS": json.dumps(parameters),
        "BENCH_PORTS_ONLY": "1" if netlist else "",
        "COCOTB_LOG_LEVEL": os.environ.get("COCOTB_LOG_LEVEL", "WARNING"),
        **PLAIN_ASSERTIONS,
        **(env or {}),
    }
    case = os.environ.get("CASE") or only
    if case:
        extra["COCOTB_TEST_FILTER"] = case
    place = folder / (own or "_".join(m.rsplit(".", 1)[-1] for m in modules))
    place.mkdir(exist_ok=True)
    log, xml = place / "test.log", place / "results.xml"
    xml.unlink(missing_ok=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        runner.test(
            hdl_toplevel=top,
            hdl_toplevel_lang="verilog",
            test_module=modules,
            build_dir=folder,
            test_dir=place,
            results_xml=str(xml),
            extra_env=extra,
            waves=os.environ.get("WAVES") == "1",
            timescale=("1ns", "1ps"),
            log_file=log,
        )
    except SystemExit:
        pass  # the runner's way to say that a test failed; the results say which
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    record_property("cpu", after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime)
    assert xml.exists(), f"the simulation ended without results; see {log}"
    found = results(xml)
    record_property("cocotb", [(f"{sim}{' netlist' if netlist else ''} {test}", ok) for test, ok in found])
    assert found, f"no cocotb test ran; see {log}"
    bad = [test for test, ok in found if not ok]
    if bad:
        pytest.fail(f"{len(bad)} of {len(found)} failed: {', '.join(bad)}\n{_why(log)}", pytrace=False)


def _why(log):
    """The lines of a simulation log that say what was expected and what was seen."""
    lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
    wanted = [s.strip() for s in lines if "Error" in s or "failed" in s or "expected" in s]
    return "\n".join(wanted[-30:] + [f"whole log: {log}"])
