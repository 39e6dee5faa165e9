"""Errors for slips of beginners: a missing pair of parentheses, an attribute of another object, an unknown argument.

What was meant follows from the type hints of the classes, so that no class lists its slips.
"""

from __future__ import annotations

import difflib
import inspect
import types
import typing
from collections import deque
from collections.abc import Callable, Iterator
from functools import partial, wraps
from typing import TYPE_CHECKING, Final, NoReturn, TypeVar, cast

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage

F = TypeVar("F", bound=Callable[..., object])
DEEPEST: Final = 4
"""Largest number of steps to the attribute that was meant, for example `positions().sim.head.yaw`."""


class Uncalled(partial[object]):
    """A bound method. It is a partial, because calling a partial adds no line to a traceback."""

    def __getattr__(self, name: str) -> object:
        if name in ("__name__", "__qualname__"):
            return getattr(self.func, name)
        if name.startswith("__"):
            raise AttributeError(name)
        way = _way(_kind(_hints(self.func).get("return")), name) or name
        raise AttributeError(f"{self.func.__name__} is a method: write {_call(self.func)}.{way}")

    def __bool__(self) -> NoReturn:
        raise TypeError(f"{self.func.__name__} is a method: write {_call(self.func)}")

    def __repr__(self) -> str:
        return f"<method {self.func.__name__}: write {_call(self.func)}>"


class _ValueMethod:
    def __init__(self, function: Callable[..., object]) -> None:
        self.function = function

    def __get__(self, instance: object, owner: type | None = None) -> Callable[..., object]:
        if instance is None:
            return self.function
        bound = Uncalled(self.function, instance)
        bound.__doc__ = self.function.__doc__
        return bound


def value_method(function: F) -> F:
    """Decorate a method that returns a value; used without parentheses, it says so."""
    return cast("F", _ValueMethod(function))


def known_arguments(initialise: F) -> F:
    """Decorate an `__init__`, so that an argument it does not have raises WrongUsage with those that it has."""
    _, *known = inspect.signature(initialise).parameters

    @wraps(initialise)
    def checked(self: object, *args: object, **named: object) -> None:
        for name in named:
            if name not in known:
                arguments = ", ".join(f"{one}=" for one in known)
                text = f"{type(self).__name__} has no argument {name}=: it has {arguments}."
                raise WrongUsage(Reason.BAD_VALUE, text)
        initialise(self, *args, **named)

    return cast("F", checked)


class Suggesting:
    """Base of classes whose missing attributes raise AttributeError with what was meant."""

    if not TYPE_CHECKING:  # a type checker would accept every attribute

        def __getattr__(self, name):
            kind = type(self)
            if name.startswith("_") or hasattr(kind, name):
                return object.__getattribute__(self, name)  # raises the error of a property again
            # Fields of a dataclass are no attributes of the class.
            names = sorted(each for each in {*dir(kind), *_hints(kind)} if not each.startswith("_"))
            close = difflib.get_close_matches(name, names, 1)
            meant = _way(kind, name) or "".join(_text(kind, each) for each in close)
            raise AttributeError(
                f"{kind.__name__} has no {name!r}: "
                + (f"did you mean {meant}?" if meant else f"it has {', '.join(names)}.")
            )


def _text(kind: type, name: str) -> str:
    """Return how to write a member of a class: `positions()`, `camera(…)` or `place`."""
    member = getattr(kind, name, None)
    return _call(member) if callable(member) else name


def _call(function: Callable[..., object]) -> str:
    _, *parameters = inspect.signature(function).parameters.values()
    needed = any(one.default is one.empty and one.kind is one.POSITIONAL_OR_KEYWORD for one in parameters)
    return f"{function.__name__}({'…' * needed})"


def _way(kind: type | None, name: str) -> str:
    """Return the shortest way from an object of this class to an attribute, as `head.yaw`; empty: there is none."""
    waiting = deque([("", kind, 1)])
    while waiting:
        way, kind, depth = waiting.popleft()
        for member, text, inner in _members(kind):
            if member == name and (way or text == name):
                return way + text
            if inner is not None and depth < DEEPEST:
                waiting.append((f"{way}{text}.", inner, depth + 1))
    return ""


def _members(kind: type | None) -> Iterator[tuple[str, str, type | None]]:
    """Yield name, how to write it, and class, of the fields, properties and value methods of a class."""
    if kind is None:
        return
    for base in reversed(kind.__mro__):
        for name, member in vars(base).items():
            if isinstance(member, _ValueMethod):
                yield name, _call(member.function), _kind(_hints(member.function).get("return"))
            elif isinstance(member, property) and not name.startswith("_"):
                yield name, name, _kind(_hints(member.fget).get("return"))
    for name, hint in _hints(kind).items():
        if not name.startswith("_"):
            yield name, name, _kind(hint)


def _hints(of: object) -> dict[str, object]:
    try:
        return typing.get_type_hints(of)
    except NameError:  # a name that is imported for type checkers only
        return {}


def _kind(hint: object) -> type | None:
    """Return the class of this package in a type hint, which may be generic or optional; None if there is none."""
    origin = typing.get_origin(hint)
    options = typing.get_args(hint) if origin in (typing.Union, types.UnionType) else ()
    for one in (hint, origin, *options):
        if isinstance(one, type) and one.__module__.startswith("beatrix_zenoh."):
            return one
    return None
