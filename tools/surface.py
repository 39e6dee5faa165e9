"""The public surface of BEATRIX, one fact a line: `python tools/surface.py` writes docs/reference/surface.txt.

--check only compares, and prints what was removed and added; docs/reference/stability.md says what either means.
A parameter has a line of its own, so that a new optional one adds a line and changes none.
"""

from __future__ import annotations

import enum
import importlib
import inspect
import pkgutil
import re
import sys
import tomllib
import typing
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Final

import typer

import beatrix_zenoh
from beatrix_zenoh import client, output, settings, shutdown
from beatrix_zenoh.cli.verbs import application
from beatrix_zenoh.contract import errors
from beatrix_zenoh.contract._generated import messages as generated

ROOT: Final = Path(__file__).resolve().parents[1]
FILE: Final = ROOT / "docs/reference/surface.txt"
SHOWN: Final = {"doc", "title", "group", "decimals", "on_change"}
"""Entries of a field of a message that change neither its bytes nor its meaning."""
CONSTRUCTED: Final = ("Robot", "Twin", "Monitor", "BeatrixError")
"""Classes that programs construct; all other objects come from a method."""
SYNTAX: Final = ("__enter__", "__iter__", "__next__")
"""Methods behind `with` and `for`."""
OURS: Final = frozenset(
    {
        *("Client", "Closable", "Robot.begin", "Robot.given_lease", "Robot.lease_number", "Robot.try_out"),
        *("Robot.preview_query", "Twin.preview_query", "Twin.start", "Twin.check_ready"),
        *("TwinMotion.end", "TwinMotion.hold", "TwinMotion.prepare", "TwinMotion.start"),
    }
)
"""Classes without their members, and members, for other packages of BEATRIX: they may change in any version."""


@cache
def classes() -> dict[str, type]:
    """Return the classes of the SDK and of its errors, by name."""
    folder = pkgutil.iter_modules(client.__path__)
    modules = [importlib.import_module(f"{client.__name__}.{one.name}") for one in folder]
    return {
        name: value
        for module in (*modules, errors)
        for name, value in vars(module).items()
        if isinstance(value, type) and value.__module__ == module.__name__
    }


def sdk() -> Iterator[str]:
    """Yield the names of `beatrix_zenoh.__all__`, the classes that their members are, and the members of both."""
    waiting, seen = list(beatrix_zenoh.__all__), set[str]()
    while waiting:
        name = waiting.pop()
        if name not in seen:
            kind = classes().get(name)
            facts = list(
                function(name, getattr(beatrix_zenoh, name)) if kind is None else members(name, kind)
            )
            yield from facts
            types = " ".join(fact.partition(": ")[2] for fact in facts)
            waiting += [word for word in re.findall(r"[A-Z]\w+", types) if word in classes().keys() - OURS]
        seen.add(name)


def members(name: str, kind: type) -> Iterator[str]:
    """Yield the bases, constructor, attributes, properties and methods of a class; those of its bases are theirs."""
    shown = {*beatrix_zenoh.__all__, *vars(generated)}
    bases = [
        base
        for base in kind.__mro__[1:]
        if base.__name__ in shown and base.__module__.startswith("beatrix_zenoh")
    ]
    yield f"class {name}({', '.join(base.__name__ for base in bases)})"
    if name in CONSTRUCTED:
        yield from parameters(name, kind)
    if issubclass(kind, enum.Enum):
        yield from (f"{name}.{word}" for word in kind.__members__)
        return
    inherited = {member for base in bases for member in (*dir(base), *attributes(base))}
    for member, annotation in attributes(kind).items():
        if not {member, f"{name}.{member}"} & {*inherited, *OURS}:
            yield f"{name}.{member}: {annotation}"
    filled = type_arguments(kind)
    for member in sorted({*dir(kind)} - inherited):
        value = inspect.getattr_static(kind, member)
        hidden = member.startswith("_") and member not in SYNTAX
        if hidden or f"{name}.{member}" in OURS or owner(kind, member) is None:
            continue
        if isinstance(value, property) and value.fget is not None:
            yield f"{name}.{member}: {value.fget.__annotations__['return']}"
        elif callable(value := getattr(kind, member)):
            for fact in function(f"{name}.{member}", value):
                yield re.sub(r"\w+", lambda word: filled.get(word[0], word[0]), fact)


def type_arguments(kind: type) -> dict[str, str]:
    """Return the types for which the type variables of the bases of a class stand, such as Motion for MotionT."""
    bases = getattr(kind, "__orig_bases__", ())
    pairs = [
        (getattr(typing.get_origin(base), "__parameters__", ()), typing.get_args(base)) for base in bases
    ]
    return {
        variable.__name__: getattr(value, "__name__", str(value))
        for names, values in pairs
        for variable, value in zip(names, values, strict=False)  # Generic names no variables
    }


def attributes(kind: type) -> dict[str, str]:
    """Return the attributes of a class and their annotations, also those that `__init__` sets without one."""
    found: dict[str, str] = {}
    for base in kind.__mro__:
        if base.__module__.startswith("beatrix_zenoh"):
            made = vars(base).get("__init__")  # a dataclass has one without a file
            if inspect.isfunction(made) and Path(made.__code__.co_filename).exists():
                sets = re.findall(r"^ +(self\..*?)(?::.*)? = ", inspect.getsource(made), re.MULTILINE)
                found |= dict.fromkeys(re.findall(r"self\.([a-z]\w*)", " ".join(sets)), "attribute")
            found |= {
                name: getattr(value, "__forward_arg__", str(value))  # a NamedTuple has a ForwardRef
                for name, value in inspect.get_annotations(base).items()
            }
    return {name: value for name, value in found.items() if not name.startswith("_")}


def owner(kind: type, member: str) -> type | None:
    """Return the class of BEATRIX that defines a member, or None if a class of Python or msgspec does."""
    owners = (base for base in kind.__mro__ if member in vars(base))
    return next((base for base in owners if base.__module__.startswith("beatrix_zenoh")), None)


def function(name: str, value: Callable[..., object]) -> Iterator[str]:
    """Yield what a function returns, and its parameters."""
    yield f"{name}(): {value.__annotations__['return']}"
    yield from parameters(name, value)


def parameters(name: str, value: Callable[..., object]) -> Iterator[str]:
    """Yield the parameters of a function with type and default."""
    given = [one for one in inspect.signature(value).parameters.values() if one.name != "self"]
    for place, one in enumerate(given, 1):
        if one.annotation != "Client | None":  # a session to share
            word = "keyword " if one.kind is one.KEYWORD_ONLY else f"{place} "
            default = "required" if one.default is one.empty else f"default {one.default!r}"
            yield f"{name}({word}{one.name}): {one.annotation}, {default}"


def contract() -> Iterator[str]:
    """Yield keys, fields of messages, words of enumerations and codes of commands."""
    keys, messages = (
        tomllib.loads((ROOT / f"schemas/{name}.toml").read_text(encoding="utf-8"))
        for name in ("keys", "messages")
    )
    for name, row in keys.items():
        yield f"key {row['key']}: {name}, {row['kind']}, {row['payload'] or 'empty'} -> {row['reply'] or 'nothing'}"
    for message, fields in messages["message"].items():
        for name, field in fields.items():
            if isinstance(field, dict):
                facts = [f"{entry} {value!r}" for entry, value in field.items() if entry not in SHOWN]
                yield f"message {message}.{name}: {', '.join(facts)}"
    for name, words in messages["enum"].items():
        yield from (f"word {name}.{word}" for word in words if word != "doc")
    yield from (f"command {name}: {row['code']}" for name, row in messages["command"].items())


def verbs() -> Iterator[str]:
    """Yield the verbs with their arguments and options, and the extras."""
    yield from options("beatrix", root())
    yield from (f"extra {name}" for name in project()["optional-dependencies"])


def project() -> dict[str, typing.Any]:
    """Return the table of the package in pyproject.toml."""
    table: dict[str, typing.Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))[
        "project"
    ]
    return table


def root() -> typing.Any:
    """Return the command `beatrix` with all verbs, also those that another package serves."""
    processes: dict[str, str] = project()["entry-points"]["beatrix.processes"]
    command = typer.main.get_command(
        application(["", "look"])
    )  # no verb is the first word: it has all of them
    for name, place in processes.items():
        app = typer.Typer(add_completion=False)
        app.command()(getattr(importlib.import_module(place.partition(":")[0]), name))
        vars(command)["commands"][name] = typer.main.get_command(app)
    return command


def options(verb: str, command: object) -> Iterator[str]:
    """Yield the arguments and options of a verb and of its own verbs."""
    yield f"verb {verb}"
    for place, one in enumerate(vars(command)["params"], 1):
        option = one.param_type_name == "option"
        name = " ".join((*one.opts, *one.secondary_opts)) if option else f"<{place} {one.name}>"
        kind = "flag" if getattr(one, "is_flag", False) else getattr(one.type, "choices", "a value")
        yield f"verb {verb} {name}: {kind if isinstance(kind, str) else ' | '.join(map(str, kind))}{', required' * one.required}"
    for name, inner in getattr(command, "commands", {}).items():
        yield from options(f"{verb} {name}", inner)


def codes() -> Iterator[str]:
    """Yield the exit codes."""
    fixed = {"OK": 0, "failed": output.FAILED, "usage": output.USAGE, "fault of BEATRIX": shutdown.FAULT}
    fixed |= {"Ctrl-C": shutdown.INTERRUPTED, "pipe closed": output.UNREAD}
    found = fixed | {reason.value: code for reason, code in output.CODES.items()}
    yield from (f"exit code {code}: {cause}" for cause, code in found.items())


def surface() -> list[str]:
    """Return all facts, sorted."""
    names = (f"setting {name}: {settings.FILE}, BEATRIX_{name.upper()}" for name in settings.FIELDS)
    return sorted({*sdk(), *contract(), *verbs(), *codes(), *names})


def difference() -> list[str]:
    """Return the facts that the file has and BEATRIX lacks (-), and those that are new (+)."""
    now = surface()
    was = FILE.read_text(encoding="utf-8").splitlines() if FILE.exists() else []
    return [f"{'-' if fact in was else '+'} {fact}" for fact in sorted({*was} ^ {*now})]


def main() -> int:
    """Print the difference, and write the file unless --check is given; return 1 if --check finds any."""
    found = difference()
    print(*found, sep="\n", end="\n" * bool(found))
    if "--check" in sys.argv:
        return int(bool(found))
    FILE.write_text("\n".join(surface()) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
