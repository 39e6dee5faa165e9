"""Errors for a slip of beginners: a missing pair of parentheses. Python itself suggests names for a wrong one."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import partial
from typing import NoReturn


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
    """Base of classes whose methods raise an error with what was meant if they are used without parentheses."""

    def __init_subclass__(cls) -> None:
        """Let each public method that returns a value say so when it is used without parentheses."""
        super().__init_subclass__()
        for name, member in list(vars(cls).items()):
            public = inspect.isfunction(member) and not name.startswith("_")
            if public and member.__annotations__.get("return", "None") != "None":
                setattr(cls, name, _ValueMethod(member))


def _call(function: Callable[..., object]) -> str:
    _, *parameters = inspect.signature(function).parameters.values()
    needed = any(one.default is one.empty and one.kind is one.POSITIONAL_OR_KEYWORD for one in parameters)
    return f"{function.__name__}({'…' * needed})"
