#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""yosys [-q] [-l LOG|-ql LOG] [-p CMDS]... [-s SCRIPT] [SCRIPT.ys|FILE.v]...

The command line of Yosys on the pyosys wheel: a current Yosys without a system package.  The
bootstrap puts it into .venv/bin as `yosys`, where sby and FuseSoC find it.
"""

import os
import sys


def main() -> int:
    """Run the commands in the order Yosys would: files and scripts first, then -p."""
    argv, first, then, quiet, log = sys.argv[1:], [], [], False, None
    while argv:
        arg = argv.pop(0)
        if arg in ("-V", "--version"):
            import importlib.metadata as metadata

            print("Yosys", metadata.version("pyosys"), "(pyosys)")
            return 0
        if arg == "-p":
            then.append(argv.pop(0))
        elif arg == "-s":
            first.append("script " + argv.pop(0))
        elif arg in ("-l", "-ql", "-lq"):
            quiet, log = quiet or "q" in arg, argv.pop(0)
        elif arg == "-q":
            quiet = True
        elif arg.startswith("-"):
            sys.exit("yosys: unsupported option " + arg)
        else:
            first.append(("script " if arg.endswith(".ys") else "read_verilog ") + arg)
    if log or quiet:  # libyosys logs to descriptor 1, errors to descriptor 2
        os.dup2(os.open(log or os.devnull, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644), 1)
    from pyosys import libyosys

    design = libyosys.Design()
    try:
        for command in first + then:
            design.run_pass(command)
    except BaseException as error:  # Yosys has already written "ERROR: ..."
        print("yosys:", type(error).__name__, error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)  # libyosys does not survive the interpreter's own teardown
