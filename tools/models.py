# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Compiles a Verilog top with Verilator and puts it behind a C++ file: the one builder of compiled models.

The live device (sim/serve.py), the random traffic (tb/differential), the shared line (tb/multidrop), the
measurements (tb/timing_doc) and cocotb (tb/harness/runner.py) take their models from here.  What is built is kept in
build/models under a name made of the contents of everything that goes in, so a model is compiled once and a stale one
is never taken.

Needs Python's standard library only.
"""

from __future__ import annotations

import contextlib
import fcntl
import functools
import hashlib
import json
import os
import shutil
import signal
import subprocess
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import filelist

ROOT = Path(__file__).resolve().parents[1]
HEADERS = ROOT / "sim"  # line.h, model.h and others for the C++ files
CACHE = Path(os.environ.get("BENCH_BUILD", ROOT / "build")) / "models"
PREFIX = "Vmodel"  # class and header of every model, whatever its top
OPTIMISE = os.environ.get("MODELS_OPTIMISE") or "-O3"  # of the compiler; -Og for what runs for seconds
VERILATE = "verilator --cc -O3 --x-assign fast --x-initial fast --noassert -Wno-fatal --language 1364-2005"
VPI = ("--vpi", "--timescale", "1ns/1ps")  # what cocotb wants of a model
COMPILE = ("g++", "-std=c++17", OPTIMISE, "-fPIC", "-faligned-new", "-w", "-pthread", *(f"-DVM_{name}=0" for name in
           ("COVERAGE", "SC", "TRACE", "TRACE_FST", "TRACE_VCD")))  # fmt: skip
RUNTIME = ("verilated.cpp", "verilated_threads.cpp", "verilated_vpi.cpp", "verilated_dpi.cpp")  # of Verilator
VPI_ONLY = RUNTIME[2:]  # what only a model with VPI needs; the second is in newer ones only
NEWER = "fronts"  # folder of the Verilator that cocotb needs; models of the system's run twice as fast


class BuildError(RuntimeError):
    """A tool is missing or has failed; the message holds what it said."""


@dataclass(frozen=True)
class Model:
    """A Verilog top with parameters as Verilator takes them, and the C++ file that uses it as class Vmodel."""

    top: str
    wrapper: Path
    files: Sequence[Path]  # Verilog
    folders: Sequence[Path]  # of include files
    parameters: Mapping[str, object] = field(default_factory=dict)
    defines: Mapping[str, object] = field(default_factory=dict)  # for the C++ file
    shared: bool = True  # a library for ctypes; else a program
    optimise: str = OPTIMISE  # of the model itself: -O0 compiles fastest
    others: Mapping[str, Path] = field(default_factory=dict)  # {top: its file} of more tops, each class V{top}
    headers: Sequence[Path] = ()  # folders of further C++ headers
    apart: Path | None = None  # a C++ file that knows no model: compiled once for all that have it
    prefix: str = PREFIX  # the model's class
    vpi: Sequence[str] | None = None  # words for the linker: Verilog's VPI sees what the top declares, and `inside`
    inside: Sequence[tuple[str, str]] = ()  # (module, name) of what it sees below the top
    verilator: str | None = None  # the program; else `verilator()`

    def digest(self) -> str:
        """A name for the contents of everything that goes into the build."""
        settings = [self.top, sorted((k, str(v)) for k, v in self.parameters.items()), dict(self.defines), self.shared]
        settings.append(self.optimise)
        settings += [sorted(self.others)] if self.others else []
        settings += [*self.vpi, *self.inside, self.prefix, self.verilator] if self.vpi is not None else []
        out = hashlib.sha256(json.dumps(settings).encode())
        headers = [path for folder in self.folders for path in sorted(Path(folder).glob("*.vh"))]
        texts = [*self.reached, *self.others.values(), *headers, *self.own_headers(), self.wrapper, Path(__file__)]
        for path in texts + ([self.apart] if self.apart else []):
            out.update(f"{Path(path).name}\n".encode())
            out.update(Path(path).read_bytes())
        return out.hexdigest()[:16]

    @functools.cached_property
    def reached(self) -> list[Path]:
        """The Verilog files that the top needs."""
        return filelist.reached(self.top, self.files)

    def own_headers(self) -> list[Path]:
        """The headers that its C++ files may include."""
        return [path for folder in (HEADERS, *self.headers) for path in sorted(folder.glob("*.h"))]


def verilator() -> str:
    """Path of the Verilator to compile with; BuildError without one."""
    places = [p for p in os.get_exec_path() if Path(p).name != NEWER]
    found = shutil.which("verilator", path=os.pathsep.join(places)) or shutil.which("verilator")
    if not found:
        raise BuildError("verilator is not installed")
    return found


def compiled(model: Model, announce: Callable[[], None] | None = None, cache: Path = CACHE) -> Path:
    """Path of the library or program, compiled now unless that was done before; BuildError if it does not compile.

    `announce` is called before a compilation begins.
    """
    key = model.digest()
    made = cache / key / ("model.so" if model.shared else "model")
    if made.exists():  # perhaps in a folder that may only be read
        return made
    cache.mkdir(parents=True, exist_ok=True)
    with open(cache / f"{key}.lock", "w") as lock:  # two may want the same at the same moment
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not made.exists():
            if announce:
                announce()
            folder = cache / f"{key}.tmp"
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
            try:
                _build(model, folder, folder / made.name)
            except BuildError:
                raise  # build.log and the sources stay, to look at
            except BaseException:  # ended by a signal
                shutil.rmtree(folder, ignore_errors=True)
                raise
            made.parent.mkdir(exist_ok=True)
            os.replace(folder / made.name, made)  # only what is finished reaches its place
            shutil.rmtree(folder)
    return made


def _build(model: Model, folder: Path, target: Path) -> None:
    """Verilog to C++; that and the wrapper, as one text, which is half the work, to `target`."""
    program = model.verilator or verilator()
    tops = {model.prefix: (model.top, model.reached, folder)}
    tops |= {f"V{top}": (top, [file], folder / top) for top, file in model.others.items()}
    for prefix, (top, files, place) in tops.items():
        _run(
            [
                program,
                *VERILATE.split()[1:],
                *("--top-module", top, "--prefix", prefix, "--Mdir", str(place)),
                *(f"-I{one}" for one in model.folders),
                *(f"-G{name}={value}" for name, value in model.parameters.items() if prefix == model.prefix),
                *(_visible(model, folder) if model.vpi is not None else ()),
                *map(str, files),
            ],
            folder,
        )
    runtime = _include(program)
    vpi = model.vpi is not None
    compile_with = [model.optimise if word == OPTIMISE else word for word in COMPILE]
    own = (f"-I{runtime}", f"-I{runtime / 'vltstd'}")
    texts = [*sorted(folder.glob("**/*.cpp")), model.wrapper.resolve()]
    unit = folder / "unit.cc"
    unit.write_text("".join(f'#include "{path}"\n' for path in texts), encoding="utf-8")
    places = (*(place for _, _, place in tops.values()), HEADERS, *model.headers)
    _run(
        [
            *compile_with,
            *(["-shared"] if model.shared else []),
            *_header([*compile_with, *own], runtime, folder, make=model.shared or vpi),
            *(f"-D{name}={value}" for name, value in model.defines.items()),
            *(f"-I{place}" for place in places),
            *(*own, str(unit), _runtime(compile_with if vpi else COMPILE, own, runtime, folder, vpi)),
            *(_apart(model, compile_with, folder) if model.apart else ()),
            *(*(model.vpi or ()), "-o", str(target)),
        ],
        folder,
    )


@functools.cache
def _include(program: str) -> Path:
    """Where a Verilator has its headers and the sources of its runtime."""
    said = subprocess.run([program, "--getenv", "VERILATOR_ROOT"], capture_output=True, text=True, check=False)
    if said.returncode:
        raise BuildError(f"{program} --getenv VERILATOR_ROOT failed:\n{said.stderr}")
    return Path(said.stdout.strip()) / "include"


def _visible(model: Model, folder: Path) -> list[str]:
    """Verilator's words for what VPI sees of a model. All of it would make the code three times as long."""
    seen = [(model.top, "*"), *model.inside]
    rule = folder / "visible.vlt"
    lines = ["`verilator_config", *(f'public_flat_rw -module "{module}" -var "{name}"' for module, name in seen)]
    rule.write_text("\n".join(lines) + "\n", encoding="ascii")
    return [*VPI, str(rule)]


def _runtime(compile_with: Sequence[str], own: Sequence[str], include: Path, folder: Path, vpi: bool) -> str:
    """Verilator's own part, compiled once for all models, as one text: most of it is headers."""
    texts = [include / name for name in RUNTIME if (include / name).exists() and (vpi or name not in VPI_ONLY)]
    whole = folder / "verilated_all.cc"
    whole.write_text("".join(f'#include "{text}"\n' for text in texts), encoding="utf-8")
    return str(_once([*compile_with, *own, "-c"], whole, "verilated.o", folder, others=texts))


def _apart(model: Model, compile_with: Sequence[str], folder: Path) -> list[str]:
    """The object of the file that knows no model."""
    command = [*compile_with, *(f"-I{place}" for place in (HEADERS, *model.headers)), "-c"]
    return [str(_once(command, model.apart, f"{model.apart.stem}.o", folder, others=model.own_headers()))]


def _header(compile_with: Sequence[str], include: Path, folder: Path, make: bool) -> list[str]:
    """Words that put Verilator's headers, which cost more than most models, before the text, compiled once for all.

    With `make` false they are taken only if they are there: who builds one program would wait longer with them.
    """
    names = [name for name in ("verilated.h", "verilated_vpi.h") if (include / name).exists()]
    text = folder / "verilator.h"
    text.write_text("".join(f"#include <{name}>\n" for name in names), encoding="ascii")
    made = _once([*compile_with, "-x", "c++-header"], text, "verilator.h.gch", folder, make)
    plain = made.with_suffix("")  # g++ looks for NAME.gch beside it
    if made.exists() and not plain.exists():
        os.replace(text, plain)
    return ["-include", str(plain)] if made.exists() else []


def _once(
    command: Sequence[str], text: Path, name: str, folder: Path, make: bool = True, others: Sequence[Path] = ()
) -> Path:
    """Where `text`, which includes `others`, is compiled by `command`: beside `folder`, or in MODELS_RUNTIME.

    Made now, if `make`, unless that was done before.
    """
    contents = b"".join(path.read_bytes() for path in (text, *others))
    key = hashlib.sha256(" ".join(command).encode() + contents).hexdigest()[:16]
    place = Path(os.environ.get("MODELS_RUNTIME", folder.parent))
    place.mkdir(parents=True, exist_ok=True)
    made = place / f"runtime_{key}_{name}"
    with open(place / f"runtime_{key}.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if make and not made.exists():
            fresh = folder / made.name
            _run([*command, str(text), "-o", str(fresh)], folder)
            os.replace(fresh, made)
    return made


def _compiler_cache(environment: Mapping[str, str], place: Path) -> dict[str, str]:
    """A folder for ccache, which g++ may be, where it could not make its own: without one it compiles nothing."""
    if "CCACHE_DIR" in environment or "CCACHE_CONFIGPATH" in environment:
        return {}
    if "ccache" not in Path(shutil.which("g++") or "").resolve().name:
        return {}
    try:
        wanted = Path(environment.get("XDG_CACHE_HOME") or Path(environment.get("HOME") or "/nonexistent") / ".cache")
        wanted.mkdir(parents=True, exist_ok=True)
        usable = os.access(wanted, os.W_OK)
    except OSError:
        usable = False
    return {} if usable else {"CCACHE_DIR": str(place / "ccache")}


def _run(command: list[str], folder: Path) -> str:
    """Output of a command, which ends with us; BuildError if it fails. All that is said is in build.log."""
    environment = {k: v for k, v in os.environ.items() if k not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL")}
    environment |= _compiler_cache(environment, folder.parent)
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    try:
        process = subprocess.Popen(command, env=environment, start_new_session=True, **pipes)
    except FileNotFoundError:
        raise BuildError(f"{command[0]} is not installed") from None
    try:
        said, wrong = process.communicate()
    except BaseException:  # ended by a signal: the compilers end too
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        raise
    with (folder / "build.log").open("a", encoding="utf-8") as log:
        log.write(f"$ {' '.join(command)}\n{said}{wrong}")
    if process.returncode:
        raise BuildError(f"{' '.join(command[:3])} ... in {folder} failed:\n{wrong[-4000:]}")
    return said
