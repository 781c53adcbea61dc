"""The module `unreal` without Unreal: it knows the names in `api.toml` only, and writes down every call.

It refuses whatever Unreal would: unknown names and properties, missing or superfluous arguments, values of another type. What
a call does is up to a project (`unreal_project.py`): its method `do_<name>`, given the object and the arguments by their names. A
call without one does nothing, and is True where the table wants a bool.
"""

from __future__ import annotations

import tomllib
import types
from collections.abc import Callable
from pathlib import Path
from typing import Any

API = tomllib.loads(Path(__file__).with_name("api.toml").read_text(encoding="utf-8"))
PLAIN = {"bool": bool, "dict": dict, "float": (int, float), "int": int, "list": list, "str": str}


class Refused(Exception):
    """A call that Unreal would refuse too, or that is not in the table."""


def lineage(kind: str) -> list[str]:
    """A class and those that it comes from."""
    base = API["classes"][kind].get("base")
    return [kind, *(lineage(base) if base else [])]


def entry(kind: str, section: str, name: str) -> Any:
    """The table entry of a method, function or property of a class."""
    for ancestor in lineage(kind):
        found = API["classes"][ancestor].get(section, {})
        if name in found:
            return found[name]
    raise Refused(f"{kind} has no {section} `{name}` in the table (see {API['pages'].format(name=kind)})")


def check_type(value: Any, wanted: str, where: str) -> None:
    """Refuses a value of another type."""
    if wanted.startswith("["):
        check_type(value, "list", where)
        for item in value:
            check_type(item, wanted[1:-1], where)
        return
    if wanted == "type":
        fits = isinstance(value, Kind)
    elif wanted in API["enums"]:
        fits = isinstance(value, Member) and value.enum == wanted
    elif wanted in API["classes"]:
        fits = value is None or isinstance(value, Thing) and wanted in lineage(value.kind)
    else:
        # To Python, but not to Unreal, a bool is a number.
        fits = isinstance(value, PLAIN[wanted]) and isinstance(value, bool) == (wanted == "bool")
    if not fits:
        raise Refused(f"{where} is {wanted}, not {value!r}")


def bind(parameters: list[str], given: tuple, named: dict[str, Any], where: str) -> dict[str, Any]:
    """Arguments by the names of their parameters."""
    names = [parameter.split(":")[0] for parameter in parameters]
    arguments = dict(zip(names, given, strict=False)) | named
    if len(given) + len(named) != len(names) or set(arguments) != set(names):
        raise Refused(f"{where} takes {names}, not {len(given)} arguments and {sorted(named)}")
    for parameter in parameters:
        name, wanted = parameter.split(":")
        check_type(arguments[name], wanted, f"{name} of {where}")
    return arguments


class Member:
    """A member of an enum."""

    def __init__(self, enum: str, name: str):
        if name not in API["enums"][enum]:
            raise Refused(f"{enum} has no member `{name}` in the table (see {API['pages'].format(name=enum)})")
        self.enum, self.name = enum, name

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Member) and repr(self) == repr(other)

    def __hash__(self) -> int:
        return hash(repr(self))

    def __repr__(self) -> str:
        return f"{self.enum}.{self.name}"


class Enum:
    """An enum of the table."""

    def __init__(self, name: str):
        self._name = name

    def __getattr__(self, name: str) -> Member:
        return Member(self._name, name)


class Kind:
    """A class of the table."""

    def __init__(self, stub: Stub, name: str):
        self._stub, self._name = stub, name

    def __call__(self, *given: Any, **named: Any) -> Thing:
        fields = API["classes"][self._name].get("new")
        if fields is None:
            raise Refused(f"{self._name} is not made by hand")
        # Structs may be made with fewer fields; the others are 0.
        missing = {name: 0.0 for name in (field.split(":")[0] for field in fields[len(given) :]) if name not in named}
        return self._stub.thing(self._name, bind(fields, given, missing | named, self._name))

    def __getattr__(self, name: str) -> Callable[..., Any]:
        return self._stub.callable(None, self._name, name, entry(self._name, "functions", name))

    def __repr__(self) -> str:
        return self._name


class Thing:
    """An object of Unreal."""

    def __init__(self, stub: Stub, kind: str, label: str, fields: dict[str, Any]):
        self._stub, self.kind, self.label, self.fields = stub, kind, label, fields

    def __getattr__(self, name: str) -> Any:
        if name in API["classes"][self.kind].get("attributes", []):
            return self.fields[name]
        return self._stub.callable(self, self.label, name, entry(self.kind, "methods", name))

    def __repr__(self) -> str:
        if "StructBase" in lineage(self.kind):
            return f"{self.kind}({', '.join(f'{name}={value!r}' for name, value in self.fields.items())})"
        return self.label


class Stub:
    """Checks calls, writes them down in `calls`, and lets a project do them."""

    def __init__(self) -> None:
        self.calls: list[str] = []
        self._counts: dict[str, int] = {}

    def module(self) -> types.ModuleType:
        """The module `unreal`."""
        module = types.ModuleType("unreal")
        # Unlike the module's default error, this says where to look.
        module.__getattr__ = lambda name: self._unknown(name)
        for name in API["classes"]:
            setattr(module, name, Kind(self, name))
        for name in API["enums"]:
            setattr(module, name, Enum(name))
        for name, function in API["functions"].items():
            setattr(module, name, self.callable(None, "unreal", name, function))
        return module

    def thing(self, kind: str, fields: dict[str, Any] | None = None, label: str | None = None) -> Thing:
        """A new object; without a label it is numbered."""
        self._counts[kind] = self._counts.get(kind, 0) + 1
        return Thing(self, kind, label or f"{kind}_{self._counts[kind]}", fields or {})

    def callable(self, thing: Thing | None, owner: str, name: str, what: dict[str, Any]) -> Callable[..., Any]:
        """A method or function of the table."""

        def call(*given: Any, **named: Any) -> Any:
            where = f"{owner}.{name}"
            arguments = bind(what["parameters"], given, named, where)
            shown = arguments.get("properties", arguments)
            named_properties = "properties" in arguments
            text = (f"{key}={value!r}" if named_properties else repr(value) for key, value in shown.items())
            self.calls.append(f"{where}({', '.join(text)})")
            do = getattr(self, f"do_{name}", None)
            result = do(thing, **arguments) if do else what.get("returns") == "bool" or None
            if "returns" in what and result is not None:
                check_type(result, what["returns"], f"the result of {where}")
            return result

        return call

    def _unknown(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        raise Refused(f"`unreal.{name}` is not in the table")
