"""Zenoh and forks: its threads do not exist in a forked child, where every call of it would wait for ever.

A session opened by the parent does not work in the child, and the child of a process that has ever opened one cannot
open its own. Both are refused, and nothing of Zenoh is called.
"""

from __future__ import annotations

import os
from typing import Final, NoReturn, Self
from weakref import WeakSet

from beatrix_zenoh.contract.errors import wrong_usage

CURE: Final = (
    'Start the child with the start method "spawn", for example with multiprocessing.get_context("spawn"), and create '
    "the Robot in the child. See docs/how-to/processes.md."
)


class _Opened:
    """The process of the first session; module state, because Zenoh's threads belong to the process, too."""

    pid = 0


def opening() -> None:
    """Remember that this process opens a session.

    Raises WrongUsage (BAD_VALUE) in a process that was forked after its parent had opened one.
    """
    if _Opened.pid not in (0, os.getpid()):
        raise wrong_usage(
            f"This process cannot connect, because process {_Opened.pid}, from which it was forked, has connected "
            f"before. {CURE}",
        )
    _Opened.pid = os.getpid()


class ProcessBound:
    """An object that works only in the process that created it. A forked child gets an `Inherited` instead."""

    def __new__(cls, *_args: object, **_more: object) -> Self:
        """Create the object and remember it for a fork."""
        made = super().__new__(cls)
        _living.add(made)
        return made

    @property
    def _inherited(self) -> bool:
        """Whether this process is a forked child of the one that created the object."""
        return _Opened.pid not in (0, os.getpid())

    def __reduce_ex__(self, _protocol: object) -> NoReturn:
        raise wrong_usage(
            f"{type(self).__name__} works only in the process that created it, so it can neither be copied nor passed "
            f"to another process: pass the robot's name. {CURE}",
        )


class Inherited(ProcessBound):
    """What an object of the parent is in a forked child: it refuses every use, and closes without doing anything.

    Its methods are called instead of those of the object's class, so that none waits for a lock that a thread of the
    parent has held. The attributes keep their values.
    """

    _class: str

    def __getattr__(self, name: str) -> NoReturn:
        if name.startswith("__"):
            raise AttributeError(name)
        self._refuse()

    def _refuse(self) -> NoReturn:
        raise wrong_usage(
            f"{self._class} works only in the process that created it: this process was forked from process "
            f"{_Opened.pid}. {CURE}",
        )

    def close(self) -> None:
        """Do nothing: the parent closes its own object."""

    def __exit__(self, *exc: object) -> None:
        pass

    def __repr__(self) -> str:
        return f"<{self._class} of process {_Opened.pid}>"

    __enter__ = __iter__ = _refuse


def _inherit() -> None:
    """Turn the objects of the parent into `Inherited`; runs in a forked child before anything else.

    They are kept for ever, because Zenoh would wait while it deletes a session.
    """
    if _Opened.pid:
        for one in list(_living):
            vars(one).setdefault("_class", type(one).__name__)
            one.__class__ = Inherited
            _kept.append(one)


_living: WeakSet[ProcessBound] = WeakSet()
_kept: list[ProcessBound] = []
if hasattr(os, "register_at_fork"):  # not on Windows, which has no forks
    os.register_at_fork(after_in_child=_inherit)
