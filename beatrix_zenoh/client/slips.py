"""Errors for slips of beginners: a missing pair of parentheses, and a wrong name."""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, NoReturn


class Uncalled(partial[object]):
    """A bound method. It is a partial, because calling a partial adds no line to a traceback."""

    def __getattr__(self, name: str) -> object:
        if name in ("__name__", "__qualname__"):
            return getattr(self.func, name)
        if name.startswith("__"):
            raise AttributeError(name)
        raise AttributeError(f"{self.func.__name__} is a method: write {_call(self.func)}.{name}")

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


class Suggesting:
    """Base of classes whose missing attributes, and methods without parentheses, raise an error with what was meant."""

    def __init_subclass__(cls) -> None:
        """Let each public method that returns a value say so when it is used without parentheses."""
        super().__init_subclass__()
        for name, member in list(vars(cls).items()):
            public = inspect.isfunction(member) and not name.startswith("_")
            if public and member.__annotations__.get("return", "None") != "None":
                setattr(cls, name, _ValueMethod(member))

    if not TYPE_CHECKING:  # a type checker would accept every attribute

        def __getattr__(self, name):
            kind = type(self)
            if name.startswith("_") or hasattr(kind, name):
                return object.__getattribute__(self, name)  # raises the error of a property again
            # Fields of a dataclass are no attributes of the class.
            fields = getattr(kind, "__dataclass_fields__", ())
            names = sorted(each for each in {*dir(kind), *fields} if not each.startswith("_"))
            meant = "".join(_text(kind, each) for each in difflib.get_close_matches(name, names, 1))
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
