# SPDX-License-Identifier: Apache-2.0
# Copyright (c) 2026 the project contributors
"""Home Assistant's own schema of its modbus integration, without installing Home Assistant.

    home_assistant.py WHEEL     a YAML configuration on standard input; exit status 1 and what is wrong with it

WHEEL is that of the package `homeassistant` 2024.3.3, the last for Python 3.11. What it imports from other packages
stands in for, apart from voluptuous, in which the schema is written: the schema is read, nothing is run.
"""

import importlib.abc
import importlib.machinery
import sys
import types

import voluptuous
import yaml

REAL = ("homeassistant", "voluptuous")
RUNS = "homeassistant.components.modbus.modbus"  # what the integration does; the schema needs its names only


class Anything(type):
    """A class that has every attribute and takes every argument."""

    def __getattr__(cls, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return anything(name)

    def __call__(cls, *_, **__):
        try:
            return super().__call__()
        except Exception:
            return None

    def __getitem__(cls, _):
        return cls

    def __or__(cls, _):
        return cls

    def __ror__(cls, _):
        return cls

    def __iter__(cls):
        return iter(())


def _attribute(_, name):
    if name.startswith("__"):
        raise AttributeError(name)
    return anything(name)


def anything(name):
    """Such a class; its objects are decorators that change nothing."""
    return Anything(
        name,
        (Exception,),
        {
            "__init__": lambda self, *_, **__: None,
            "__call__": lambda self, *given, **_: given[0] if given and callable(given[0]) else self,
            "__getattr__": _attribute,
        },
    )


class Module(types.ModuleType):
    """A module that has every name."""

    __path__ = ()

    def __getattr__(self, name):
        return _attribute(self, name)


class Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds what is not installed."""

    def find_spec(self, fullname, path=None, target=None):
        if fullname.split(".")[0] in REAL:
            return None
        return importlib.machinery.ModuleSpec(fullname, self, is_package=True)

    def create_module(self, spec):
        return Module(spec.name)

    def exec_module(self, module):
        pass


def main():
    sys.path.insert(0, sys.argv[1])
    sys.modules[RUNS] = Module(RUNS)
    sys.meta_path.append(Finder())
    from homeassistant.components import modbus

    try:
        modbus.CONFIG_SCHEMA(yaml.safe_load(sys.stdin.read()))
    except voluptuous.Invalid as wrong:
        sys.exit(str(wrong))


if __name__ == "__main__":
    main()
