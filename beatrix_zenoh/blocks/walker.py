"""Carries a program of blocks out, block by block; nothing of it is executed as code."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from typing import Final, Protocol

from beatrix_zenoh.blocks.program import AXES, LARGEST, Block, Program, too_large, wrong

PAUSE_S: Final = 0.02
"""Time (s) after each round of a loop, for the processor; robots publish no more positions."""
CALCULATE: Final[Mapping[str, Callable[[float, float], object]]] = {
    "ADD": operator.add,
    "MINUS": operator.sub,
    "MULTIPLY": operator.mul,
    "DIVIDE": operator.truediv,
    "POWER": operator.pow,
}
COMPARE: Final = {"LT": operator.lt, "LTE": operator.le, "GT": operator.gt, "GTE": operator.ge}


class Driven(Protocol):
    """What a program moves: one robot, or both. Motions return at their ends; angles in degrees, speeds in deg/s.

    An error of any method ends the program.
    """

    def begin(self, block: str) -> None:
        """Note the id of the block that begins."""

    def check(self) -> None:
        """Raise the reason why the program must end, if there is one."""

    def look(self, yaw: float, pitch: float, roll: float, speed: float | None) -> None:
        """Turn the head; None: at the robot's own speed."""

    def move_arm(self, arm: str, angle: float, speed: float | None) -> None:
        """Turn one arm."""

    def home(self, speed: float | None) -> None:
        """Move all arms home."""

    def gesture(self, name: str) -> None:
        """Play a shipped gesture, which ends at home."""

    def wait(self, seconds: float) -> None:
        """Wait, for ever if `seconds` is infinite; raises as `check` does, as soon as the program must end."""

    def position(self, part: str) -> float:
        """Return the present angle of the head (yaw, pitch, roll) or of an arm."""


class Walker:
    """One run of a program: its variables, the target of the head (deg), and the speed (deg/s)."""

    def __init__(self, program: Program, robot: Driven) -> None:
        """Store the arguments."""
        self._program, self._robot = program, robot
        self._variables: dict[str, float] = dict.fromkeys(program.variables, 0.0)
        self._head = dict.fromkeys(AXES.values(), 0.0)
        self._speed: float | None = None

    def run(self) -> None:
        """Carry the program out to its end; raises WrongProgram, and the errors of the robot."""
        self._row(self._program.blocks)

    def _row(self, blocks: tuple[Block, ...]) -> None:
        for block in blocks:
            self._robot.begin(block.id)
            self._robot.check()
            if block.rows:
                self._control(block)
            else:
                self._step(block)

    def _step(self, block: Block) -> None:
        """Carry out a block that contains no rows."""
        robot, fields, speed = self._robot, block.fields, self._speed
        match block.kind:
            case "home":
                robot.home(speed)
                self._head = dict.fromkeys(AXES.values(), 0.0)
            case "gesture":
                robot.gesture(fields["NAME"])
                self._head = dict.fromkeys(AXES.values(), 0.0)
            case "arm":
                robot.move_arm(fields["ARM"], self._number(block, "ANGLE"), speed)
            case "speed":
                self._speed = self._number(block, "SPEED")
            case "wait":
                seconds = self._number(block, "SECONDS")
                if seconds < 0:
                    raise wrong("time", block.id, value=f"{seconds:g}")
                robot.wait(seconds)
            case "wait_stop":
                robot.wait(math.inf)
            case "variables_set":
                self._variables[fields["VAR"]] = self._value(block.values["VALUE"])
            case "math_change":
                old, change = self._variables[fields["VAR"]], self._number(block, "DELTA")
                if isinstance(old, bool):
                    raise wrong("number", block.id)
                self._variables[fields["VAR"]] = _checked(old + change, block)
            case _:
                self._head[AXES[block.kind]] = self._number(block, "ANGLE")
                robot.look(**self._head, speed=speed)

    def _control(self, block: Block) -> None:
        """Carry out a block that decides whether, and how often, its rows run."""
        match block.kind:
            case "controls_if":
                chosen = next((key for key in block.values if self._condition(block, key)), "ELSE")
                self._row(block.rows[chosen.replace("IF", "DO")])
            case "controls_repeat_ext":
                for _ in range(round(self._number(block, "TIMES"))):
                    self._round(block)
            case "controls_whileUntil":
                while self._condition(block, "BOOL") is (block.fields["MODE"] == "WHILE"):
                    self._round(block)
            case "forever":
                while True:
                    self._round(block)

    def _round(self, block: Block) -> None:
        self._row(block.rows["DO"])
        self._robot.wait(PAUSE_S)

    def _number(self, block: Block, name: str) -> float:
        value = self._value(block.values[name])
        if isinstance(value, bool):
            raise wrong("number", block.values[name].id)
        return value

    def _condition(self, block: Block, name: str) -> bool:
        value = self._value(block.values[name])
        if not isinstance(value, bool):
            raise wrong("condition", block.values[name].id)
        return value

    def _value(self, block: Block) -> float:
        """Return the value of a block: a number, or true or false."""
        fields, values, result = block.fields, block.values, 0.0
        match block.kind:
            case "math_number":
                result = float(fields["NUM"])
            case "variables_get":
                result = self._variables[fields["VAR"]]
            case "position":
                result = self._robot.position(fields["PART"])
            case "logic_boolean":
                result = fields["BOOL"] == "TRUE"
            case "logic_negate":
                result = not self._condition(block, "BOOL")
            case "logic_operation":
                result = self._condition(block, "A")
                if result is (fields["OP"] == "AND"):
                    result = self._condition(block, "B")
            case "logic_compare" if fields["OP"] in ("EQ", "NEQ"):
                result = (self._value(values["A"]) == self._value(values["B"])) is (fields["OP"] == "EQ")
            case "logic_compare":
                result = COMPARE[fields["OP"]](self._number(block, "A"), self._number(block, "B"))
            case _:
                result = self._calculated(block)
        return result

    def _calculated(self, block: Block) -> float:
        numbers = self._number(block, "A"), self._number(block, "B")
        try:
            return _checked(CALCULATE[block.fields["OP"]](*numbers), block)
        except ZeroDivisionError:
            raise wrong("zero", block.id) from None
        except OverflowError:
            raise too_large(block.id) from None


def _checked(number: object, block: Block) -> float:
    """Return a result that is a number, and small enough: a power may be complex."""
    if not isinstance(number, float) or not abs(number) <= LARGEST:
        raise too_large(block.id)
    return number
