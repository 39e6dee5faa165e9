"""A program of blocks as Python for the SDK, which does the same."""

from __future__ import annotations

import keyword
import re
import unicodedata
from collections.abc import Mapping
from typing import Final

from beatrix_zenoh.blocks.program import ARITHMETIC, AXES, COMPARISONS, LOGIC, Block, Program, inside
from beatrix_zenoh.contract.names import ARMS

TAKEN: Final = {*AXES.values(), *"Robot __debug__ event load next play range robot round speed time".split()}  # noqa: SIM905
"""Names that the text uses for something else than the variables of the program."""
LINES: Final = {
    "home": "robot.{HOME}",
    "arm": "robot.move(*robot.positions().commanded._replace({ARM}={ANGLE}){AT})",
    "speed": "speed = {SPEED}",
    "wait": "time.sleep({SECONDS})",
    "gesture": 'play(robot, load("{NAME}"))',
    "wait_stop": 'next(event for event in robot.events() if event.kind == "stop")  # wait for STOP',
    "forever": "while True:",
    "controls_repeat_ext": "for _ in range({TIMES}):",
    "controls_whileUntil": "while {BOOL}:",
    "variables_set": "{VAR} = {VALUE}",
    "math_change": "{VAR} += {DELTA}",
    "math_number": "{NUM}",
    "variables_get": "{VAR}",
    "position": "robot.positions().{PART}",
    "logic_negate": "not {BOOL}",
    "logic_boolean": "{BOOL}",
    **dict.fromkeys(("math_arithmetic", "logic_compare", "logic_operation"), "{A} {OP} {B}"),
}
"""The text of each block; names in braces are its fields and inputs. AT and HOME contain the speed, if there is one."""
WORDS: Final = {
    "OP": ARITHMETIC | COMPARISONS | LOGIC,
    "BOOL": {"TRUE": "True", "FALSE": "False"},
    "PART": {part: f"{'arms' if part in ARMS else 'head'}.{part}" for part in (*AXES.values(), *ARMS)},
}
"""What is written for the values of fields; others are written as they are."""


def text(program: Program) -> str:
    """Return the text of a whole program, in the manner of the lessons."""
    writer = _Writer(program)
    kinds, begin = writer.kinds, writer.upright
    lines = ["import time", ""] if "wait" in kinds else []
    lines += ["from beatrix_zenoh import Robot"]
    lines += ["from beatrix_zenoh.client.choreography import load, play"] if "gesture" in kinds else []
    lines += ["", "robot = Robot()", "robot.make_ready()", ""]
    begin += ["speed = None  # the robot's own"] if "speed" in kinds else []
    begin += [f"{name} = 0" for name in writer.used]
    lines += [*begin, ""] if begin else []
    return "\n".join((*lines, *writer.row(program.blocks), ""))


def _names(variables: Mapping[str, str]) -> dict[str, str]:
    """Return a valid name of Python for each variable, by its id."""
    names: dict[str, str] = {}
    for key, title in variables.items():
        name = re.sub(r"\W", "_", unicodedata.normalize("NFKC", title))
        name = next(one for one in (name, f"x{name}", f"x{len(names)}") if one.isidentifier())
        while keyword.iskeyword(name) or name in TAKEN or name in names.values() or name == "_":
            name += "_"
        names[key] = name
    return names


class _Writer:
    """Writes blocks as lines."""

    def __init__(self, program: Program) -> None:
        blocks = [*inside(program.blocks)]
        self.kinds = {block.kind for block in blocks}
        self._names = _names(program.variables)
        ids = {block.fields["VAR"] for block in blocks if "VAR" in block.fields}
        self.used = [name for key, name in self._names.items() if key in ids]
        """names of the variables that the program uses"""
        axes = [axis for kind, axis in AXES.items() if kind in self.kinds]
        self._axes = axes if len(axes) > 1 else []
        """the axes whose targets are variables, because each motion repeats those of the other axes"""
        speed = "speed" in self.kinds
        self._at, self._home = (", speed=speed", "move(0, 0, 0, speed=speed)") if speed else ("", "home()")

    @property
    def upright(self) -> list[str]:
        """The line that sets the targets of the head to 0; empty if they are no variables."""
        return [f"{' = '.join(self._axes)} = 0"] if self._axes else []

    def row(self, blocks: tuple[Block, ...]) -> list[str]:
        """Return the lines of blocks below each other."""
        lines: list[str] = []
        for block in blocks:
            if block.kind == "controls_if":
                lines += self._branches(block)
            elif block.rows:
                lines += self._indented(self._line(block), block.rows["DO"])
            elif block.kind in AXES:
                lines += self._look(AXES[block.kind], self._value(block.values["ANGLE"]))
            else:
                lines += [self._line(block), *(self.upright if block.kind in ("home", "gesture") else [])]
        return lines

    def _indented(self, head: str, blocks: tuple[Block, ...]) -> list[str]:
        return [head, *(f"    {line}" for line in self.row(blocks) or ["pass"])]

    def _branches(self, block: Block) -> list[str]:
        lines: list[str] = []
        for key, value in block.values.items():
            head = f"{'elif' if lines else 'if'} {self._value(value)}:"
            lines += self._indented(head, block.rows[key.replace("IF", "DO")])
        last = block.rows["ELSE"]
        return [*lines, *self._indented("else:", last)] if last else lines

    def _look(self, axis: str, angle: str) -> list[str]:
        if not self._axes:
            return [f"robot.look({axis}={angle}{self._at})"]
        return [
            f"{axis} = {angle}",
            f"robot.look({', '.join(f'{one}={one}' for one in self._axes)}{self._at})",
        ]

    def _line(self, block: Block) -> str:
        """Return the text of a statement."""
        words = {key: self._value(value) for key, value in block.values.items()}
        if block.fields.get("MODE") == "UNTIL":
            words["BOOL"] = f"not {self._operand(block.values['BOOL'])}"
        if "TIMES" in words and not words["TIMES"].isdigit():
            words["TIMES"] = f"round({words['TIMES']})"
        return LINES[block.kind].format(**self._fields(block), **words, AT=self._at, HOME=self._home)

    def _value(self, block: Block) -> str:
        values = {key: self._operand(value) for key, value in block.values.items()}
        return LINES[block.kind].format(**self._fields(block), **values)

    def _operand(self, block: Block) -> str:
        """Return a value inside an operation, in parentheses if it is an operation or has a sign."""
        value = self._value(block)
        return f"({value})" if " " in value or value.startswith("-") else value

    def _fields(self, block: Block) -> dict[str, str]:
        words = {key: WORDS.get(key, {}).get(value, value) for key, value in block.fields.items()}
        return words | ({"VAR": self._names[words["VAR"]]} if "VAR" in words else {})
