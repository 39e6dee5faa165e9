"""A program of 2023 at the port of a node."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec
import serial
from robots import Stage, ask_raw, until

from beatrix_zenoh.client import lease
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Event, Events, LeaseAction
from beatrix_zenoh.contract.names import OLD_PROGRAMS, TEACHER

PATIENCE_S = 40.0


class Program:
    """A program of 2023, which opens its serial port with pyserial."""

    def __init__(self, path: Path, begun: Callable[[], None] = lambda: None) -> None:
        self.port = serial.Serial(str(path), 9600, timeout=PATIENCE_S)
        self._begun = begun

    def say(self, line: str, answers: int = 2) -> list[str]:
        """Send a line and return this number of reply lines."""
        self.port.write(line.encode() + b"\r")
        return self.read(answers)

    def read(self, lines: int) -> list[str]:
        """Return the next lines from the port."""
        return [self.port.readline().decode() for _ in range(lines)]

    def begin(self) -> Program:
        """Enable the motors and set the zero, as programs of 2023 do first."""
        assert self.say("@ENMOTORS ON") == self.say("@CALNOW") == ["ACK\n", "ACK\n"]
        self._begun()
        return self

    @property
    def x(self) -> int:
        """Position of the short arm as the program reads it."""
        return int(self.say("@GETXPOS", 3)[1])


class Place:
    """A robot with a port for old programs."""

    def __init__(self, stage: Stage, side: str, path: Path) -> None:
        self.stage, self.path, self._side = stage, path, side
        self.robot = stage.robot("bea", side)
        self.start = 0.0

    def far(self) -> bool:
        """Return whether the robot is moving and its short arm is more than 2 deg from the start."""
        return self.robot.status().moving and abs(self.robot.positions().commanded.short - self.start) > 2

    def turn(self, steps: int) -> bytes:
        """Return the line that turns the head by this many steps, away from its limit."""
        away = -steps if self.robot.positions().commanded.short > 0 else steps
        return f"@MOVRALL {away} {away} {away} 200\r".encode()

    def events(self, since: int = -1) -> list[Event]:
        """Return the stored events with a number above `since`, oldest first."""
        (answer,) = ask_raw(self.robot.client, keys.events_json("bea", self._side))
        events = msgspec.json.decode(answer.payload, type=Events).events
        return [event for event in events if event.seq > since]

    def newest_event(self) -> int:
        """Return the number of the newest event; -1 if there is none."""
        return max((event.seq for event in self.events()), default=-1)

    def _remember(self) -> None:
        """Store the position from which `far` measures, after @CALNOW, which may set a simulated head upright."""
        self.start = self.robot.positions().commanded.short

    def until_free(self) -> None:
        """Let the teacher end the turn of an old program or of a seat, so that the next one need not wait."""
        lease.ask(self.stage.robot("bea", self._side, TEACHER), LeaseAction.GIVE_BACK)
        until(lambda: self.robot.status().holder == "", "free")

    @contextlib.contextmanager
    def program(self) -> Iterator[Program]:
        """Open the port with a program when no other seat drives; close it and stop the robot at the end."""
        until(lambda: self.robot.status().holder in ("", OLD_PROGRAMS), "free")
        program = Program(self.path, self._remember)
        try:
            yield program
        finally:
            program.port.close()
            self.robot.stop()
