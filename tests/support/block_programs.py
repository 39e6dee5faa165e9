"""Programs of blocks for tests, as Blockly saves them, and a robot that only records what they ask for."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from types import SimpleNamespace
from typing import Any

from beatrix_zenoh.blocks.program import AXES
from beatrix_zenoh.blocks.walker import PAUSE_S
from beatrix_zenoh.contract.names import ARMS

Saved = dict[str, Any]
ROUNDS_MAX = 2000


def block(
    kind: str, fields: Mapping[str, object] | None = None, **inputs: Saved | list[Saved] | float
) -> Saved:
    """Return a block; an input is a number (a shadow), a value, or a list of blocks below each other."""
    found: Saved = {"type": kind, "id": f"{kind}-id", "fields": dict(fields or {}), "inputs": {}}
    for name, value in inputs.items():
        if isinstance(value, list):
            found["inputs"][name] = {"block": row(value)} if value else {}
        elif isinstance(value, dict):
            found["inputs"][name] = {"shadow": number(0), "block": value}
        else:
            found["inputs"][name] = {"shadow": number(value)}
    return found


def number(value: float) -> Saved:
    """Return a block with a number."""
    return {"type": "math_number", "id": "number-id", "fields": {"NUM": value}}


def variable(name: str) -> Mapping[str, object]:
    """Return the field of a variable."""
    return {"VAR": {"id": f"id of {name}"}}


def row(blocks: Sequence[Saved]) -> Saved:
    """Return the first of blocks below each other."""
    first, *others = blocks
    return {**first, "next": {"block": row(others)}} if others else dict(first)


def saved(*blocks: Saved, variables: Sequence[str] = ("x", "y")) -> str:
    """Return a program with these blocks below Start."""
    start: Saved = {"type": "start", "id": "start", "x": 10, "y": 10}
    start |= {"next": {"block": row(blocks)}} if blocks else {}
    names = [{"name": name, "id": f"id of {name}"} for name in variables]
    return json.dumps({"blocks": {"languageVersion": 0, "blocks": [start]}, "variables": names})


def repeat(times: float, *blocks: Saved) -> Saved:
    """Return a block that repeats others."""
    return block("controls_repeat_ext", TIMES=times, DO=list(blocks))


def lesson_1(refused_deg: float = 60) -> str:
    """Return lesson 1: the head nods twice, shakes twice, and refuses the last block."""
    nods = [block("nod", ANGLE=15), block("nod", ANGLE=-5)]
    shakes = [block("turn", ANGLE=25), block("turn", ANGLE=-25)]
    home = block("home")
    last = {**block("nod", ANGLE=refused_deg), "id": "too-far"}
    return saved(repeat(2, *nods), home, repeat(2, *shakes), home, last)


class Ended(Exception):
    """The program was long enough."""


class Recorder:
    """A robot that records what is asked of it, and raises Ended at the call of number `most`."""

    def __init__(self, most: int = 40) -> None:
        self.calls: list[tuple[object, ...]] = []
        self.blocks: list[str] = []
        self.rounds = 0
        self._most = most

    def note(self, *call: object) -> None:
        """Record a call."""
        if len(self.calls) >= self._most:
            raise Ended
        self.calls.append(call)

    # -- as the walker calls it ---------------------------------------------------------------------

    def begin(self, block: str) -> None:
        self.blocks.append(block)

    def check(self) -> None:
        pass

    def look(self, yaw: float, pitch: float, roll: float, speed: float | None) -> None:
        self.note("look", yaw, pitch, roll, speed)

    def move_arm(self, arm: str, angle: float, speed: float | None) -> None:
        self.note("arm", arm, angle, speed)

    def home(self, speed: float | None) -> None:
        self.note("home", speed)

    def gesture(self, name: str) -> None:
        self.note("gesture", name)

    def wait(self, seconds: float) -> None:
        if seconds != PAUSE_S:
            self.note("wait", seconds)
        elif (rounds := self.rounds + 1) > ROUNDS_MAX:
            raise Ended
        else:
            self.rounds = rounds  # the Python program does not pause

    def position(self, part: str) -> float:
        self.note("position", part)
        return len(self.calls) * 7.0 % 90  # depends on the number of calls only


class Angles:
    """The angles of a reading: asks for the one that is read."""

    def __init__(self, recorder: Recorder, *parts: str) -> None:
        self._recorder, self._parts = recorder, parts

    def __getattr__(self, part: str) -> float:
        assert part in self._parts
        return self._recorder.position(part)

    def _replace(self, **arms: float) -> list[tuple[str, float]]:
        return [*arms.items()]


def sdk(recorder: Recorder) -> SimpleNamespace:
    """Return a robot of the SDK that records what is asked of it in the words of the walker."""

    def look(yaw: float = 0.0, pitch: float = 0.0, roll: float = 0.0, speed: float | None = None) -> None:
        recorder.look(yaw, pitch, roll, speed)

    def move(*arms: Any, speed: float | None = None) -> None:
        if len(arms) == 1:
            arm, angle = arms[0]
            recorder.move_arm(arm, angle, speed)
        else:
            recorder.home(speed)

    def events() -> Iterator[SimpleNamespace]:
        recorder.wait(math.inf)
        yield SimpleNamespace(kind="stop")

    arms = Angles(recorder, *ARMS)
    reading = SimpleNamespace(head=Angles(recorder, *AXES.values()), arms=arms, commanded=arms)
    return SimpleNamespace(
        look=look,
        move=move,
        events=events,
        home=lambda: recorder.home(None),
        make_ready=lambda: None,
        positions=lambda: reading,
    )


def execute(text: str, recorder: Recorder) -> None:
    """Execute a program for the SDK with a robot that records."""
    modules = {
        "time": SimpleNamespace(sleep=recorder.wait),
        "beatrix_zenoh": SimpleNamespace(Robot=lambda: sdk(recorder)),
        "beatrix_zenoh.client.choreography": SimpleNamespace(
            load=str, play=lambda _, name: recorder.gesture(name)
        ),
    }
    words = {"range": range, "round": round, "next": next, "__import__": lambda name, *_: modules[name]}
    exec(compile(text, "blocks", "exec"), {"__builtins__": words})
