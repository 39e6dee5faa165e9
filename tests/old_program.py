"""A program of 2023 at the port that a node opens for it."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path

import serial
from stage import Stage, until

PATIENCE_S = 10.0


class Program:
    """A program of 2023, which opens its serial port with pyserial."""

    def __init__(self, path: Path, begun: Callable[[], None] = lambda: None) -> None:
        self.port = serial.Serial(str(path), 9600, timeout=PATIENCE_S)
        self._begun = begun

    def say(self, line: str, answers: int = 2) -> list[str]:
        """Send a line, wait for so many lines."""
        self.port.write(line.encode() + b"\r")
        return self.read(answers)

    def read(self, lines: int) -> list[str]:
        """The next lines."""
        return [self.port.readline().decode() for _ in range(lines)]

    def begin(self) -> Program:
        """As programs do."""
        assert self.say("@ENMOTORS ON") == self.say("@CALNOW") == ["ACK\n", "ACK\n"]
        self._begun()
        return self

    @property
    def x(self) -> int:
        """Where the short arm is, as the program is told."""
        return int(self.say("@GETXPOS", 3)[1])


class Place:
    """A robot with a port for old programs."""

    def __init__(self, stage: Stage, twin: str, path: Path) -> None:
        self.stage, self.path = stage, path
        self.robot = stage.robot("bea", twin)
        self.start = 0.0

    def far(self) -> bool:
        """It moves, and has made some steps."""
        return self.robot.status().moving and abs(self.robot.positions().commanded.short - self.start) > 2

    def turn(self, steps: int) -> bytes:
        """A line that turns the head by so many steps, to the side where there is room."""
        away = -steps if self.robot.positions().commanded.short > 0 else steps
        return f"@MOVRALL {away} {away} {away} 200\r".encode()

    def _remember(self) -> None:
        """Where it stands; a simulation was set upright."""
        self.start = self.robot.positions().commanded.short

    @contextlib.contextmanager
    def program(self) -> Iterator[Program]:
        """A program that has opened the port; nobody drives."""
        until(lambda: self.robot.status().holder == "", "free", 5.0)
        program = Program(self.path, self._remember)
        try:
            yield program
        finally:
            program.port.close()
            self.robot.stop()
