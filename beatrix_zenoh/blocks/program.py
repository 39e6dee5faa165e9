"""A program of blocks as data: the JSON that Blockly saves, checked as a whole before anything moves."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Final, NamedTuple

import msgspec

from beatrix_zenoh.client import own_gestures
from beatrix_zenoh.client.choreography import GESTURES
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage, quoted
from beatrix_zenoh.contract.names import ARMS

AXES: Final = {"turn": "yaw", "nod": "pitch", "tilt": "roll"}
"""The blocks that move the head, and the angle that each sets."""
ARITHMETIC: Final = {"ADD": "+", "MINUS": "-", "MULTIPLY": "*", "DIVIDE": "/", "POWER": "**"}
COMPARISONS: Final = {"EQ": "==", "NEQ": "!=", "LT": "<", "LTE": "<=", "GT": ">", "GTE": ">="}
LOGIC: Final = {"AND": "and", "OR": "or"}
BYTES_MAX: Final = 1 << 16
"""Largest size of a program (bytes): about 500 blocks."""
DEPTH_MAX: Final = 18
"""Largest number of blocks inside each other: Python allows 20 loops inside each other."""
LARGEST: Final = 1e9
"""Largest number of a program."""
SENTENCES: Final = {
    "format": "This is not a program of these blocks. Open another file, or build the program again.",
    "size": "The program has {size} bytes; at most {most} are allowed. Use repeat blocks, or delete blocks.",
    "starts": "The program has {count} start blocks; exactly one is allowed. Put your blocks below one start block.",
    "unknown": "The block {kind} is not allowed here. These are allowed: {allowed}.",
    "gap": "This block has a gap. Put a value into it.",
    "deep": "More than {most} blocks are inside each other. Put some of them below each other, or use a variable.",
    "number": "A number is needed here, but this is true or false. Put a number, or a calculation, here.",
    "condition": "True or false is needed here, but this is a number. Put a comparison here.",
    "zero": "This divides by zero, which has no result. Change the second number.",
    "large": "This number is too large, or does not exist; from -{most} to {most} is allowed. Use a smaller one.",
    "time": "This waits for {value} s; 0 s or more is allowed. Use a longer time.",
}
"""English sentences of refusals, by key."""
_TOKEN: Final = re.compile(r'[][{}]|"(?:[^"\\]|\\.)*"|[^][{},:"\s]+|"')


class WrongProgram(WrongUsage):
    """A program that cannot run, or cannot go on."""

    key, block = "format", ""
    """the key of the sentence, for another language; the id of the block, empty: the whole program"""
    slots: Mapping[str, str] = {}


def wrong(key: str, block: str = "", **slots: str) -> WrongProgram:
    """Return the refusal with the sentence of this key, about the block with this id."""
    error = WrongProgram(Reason.BAD_VALUE, SENTENCES[key].format(**slots))
    error.key, error.block, error.slots = key, block, slots
    return error


def too_large(block: str) -> WrongProgram:
    """Return the refusal of a number."""
    return wrong("large", block, most=f"{LARGEST:.0f}")


class Block(msgspec.Struct, frozen=True):
    """One block, with all blocks inside it: values, and rows of blocks below each other."""

    kind: str
    """the type of the block for Blockly, for example `turn`"""
    id: str
    fields: Mapping[str, str]
    values: Mapping[str, Block]
    rows: Mapping[str, tuple[Block, ...]]


class Program(msgspec.Struct, frozen=True):
    """The blocks below the start block, and the names of variables by their ids."""

    blocks: tuple[Block, ...]
    variables: Mapping[str, str]


class Shape(NamedTuple):
    """What a block consists of: fields with their possible values, and inputs."""

    fields: Mapping[str, Iterable[str]] = {}
    values: tuple[str, ...] = ()
    rows: tuple[str, ...] = ()


STATEMENTS: Final = {
    **dict.fromkeys(AXES, Shape(values=("ANGLE",))),
    "home": Shape(),
    "arm": Shape({"ARM": ARMS}, ("ANGLE",)),
    "speed": Shape(values=("SPEED",)),
    "wait": Shape(values=("SECONDS",)),
    "gesture": Shape({"NAME": GESTURES}),
    "wait_stop": Shape(),
    "forever": Shape(rows=("DO",)),
    "controls_repeat_ext": Shape(values=("TIMES",), rows=("DO",)),
    "controls_whileUntil": Shape({"MODE": ("WHILE", "UNTIL")}, ("BOOL",), ("DO",)),
    "controls_if": Shape(),
    "variables_set": Shape({"VAR": ()}, ("VALUE",)),
    "math_change": Shape({"VAR": ()}, ("DELTA",)),
}
"""Blocks of a row; the inputs of `controls_if` depend on its branches, VAR is a variable, NUM a number."""
VALUES: Final = {
    "position": Shape({"PART": (*AXES.values(), *ARMS)}),
    "variables_get": Shape({"VAR": ()}),
    "math_number": Shape({"NUM": ()}),
    "math_arithmetic": Shape({"OP": ARITHMETIC}, ("A", "B")),
    "logic_compare": Shape({"OP": COMPARISONS}, ("A", "B")),
    "logic_operation": Shape({"OP": LOGIC}, ("A", "B")),
    "logic_negate": Shape(values=("BOOL",)),
    "logic_boolean": Shape({"BOOL": ("TRUE", "FALSE")}),
}
_Table = dict[str, object]


class _Saved(msgspec.Struct):
    """A block as Blockly saves it."""

    type: str
    id: str = ""
    fields: _Table = {}
    inputs: dict[str, _Table] = {}
    next: _Table = {}
    extraState: dict[str, object] = {}  # noqa: N815 - Blockly's name
    disabledReasons: list[object] = []  # noqa: N815 - Blockly's name


class _Variable(msgspec.Struct):
    id: str
    name: str


class _Tops(msgspec.Struct):
    blocks: list[_Table] = []


class _Workspace(msgspec.Struct):
    blocks: _Tops = msgspec.field(default_factory=_Tops)
    variables: list[_Variable] = []


def read(text: str) -> Program:
    """Return the program in the JSON of `Blockly.serialization.workspaces.save`; raises WrongProgram.

    Blocks that are not below the start block are ignored.
    """
    size = len(text.encode("utf-8", "replace"))
    if size > BYTES_MAX:
        raise wrong("size", size=str(size), most=str(BYTES_MAX))
    try:
        saved = msgspec.convert(_parse(text), _Workspace)
        starts = [top for top in saved.blocks.blocks if top.get("type") == "start"]
        if len(starts) != 1:
            raise wrong("starts", count=str(len(starts)))
        variables = {variable.id: variable.name for variable in saved.variables}
        return Program(_row(msgspec.convert(starts[0], _Saved).next, variables, 1), variables)
    except (ValueError, TypeError) as error:
        raise wrong("format") from error


def inside(blocks: Iterable[Block]) -> Iterator[Block]:
    """Yield blocks, and all blocks inside them."""
    for block in blocks:
        yield block
        for row in (block.values.values(), *block.rows.values()):
            yield from inside(row)


def _parse(text: str) -> object:
    """Return the value of a JSON text whose commas and colons are not checked; raises ValueError or TypeError.

    It does not call itself, because each block of a row is two objects inside the block above it.
    """
    values: list[list[object]] = [[]]
    ends: list[str] = []
    for token in _TOKEN.finditer(text):
        part = token[0]  # one by one: a quote that never ends raises before the next one is looked for
        if part in ("[", "{"):
            values.append([])
            ends.append("]" if part == "[" else "}")
        elif part in ("]", "}"):
            if not ends or ends.pop() != part:
                raise ValueError(part)
            found = values.pop()
            values[-1].append(found if part == "]" else dict(zip(found[::2], found[1::2], strict=True)))
        else:
            values[-1].append(msgspec.json.decode(part))
    ((value,),) = values
    return value


def _connected(joint: _Table) -> _Saved | None:
    """Return the block of a connection; a shadow is used only if there is no other block."""
    found = joint.get("block") or joint.get("shadow")
    return None if found is None else msgspec.convert(found, _Saved)


def _row(joint: _Table, variables: Mapping[str, str], depth: int) -> tuple[Block, ...]:
    """Return the blocks below each other from a connection on, without those that the user has switched off."""
    found: list[Block] = []
    while saved := _connected(joint):
        if not saved.disabledReasons:
            found.append(_block(saved, STATEMENTS, variables, depth))
        joint = saved.next
    return tuple(found)


def _block(saved: _Saved, allowed: Mapping[str, Shape], variables: Mapping[str, str], depth: int) -> Block:
    if depth > DEPTH_MAX:
        raise wrong("deep", saved.id, most=str(DEPTH_MAX))
    if saved.type not in allowed:
        raise wrong("unknown", saved.id, kind=quoted(saved.type), allowed=", ".join(allowed))
    shape = allowed[saved.type] if saved.type != "controls_if" else _branches(saved)
    fields = {key: _field(saved, key, words, variables) for key, words in shape.fields.items()}
    values = {key: _connected(saved.inputs.get(key, {})) for key in shape.values}
    if None in values.values():
        raise wrong("gap", saved.id)
    return Block(
        saved.type,
        saved.id,
        fields,
        {key: _block(value, VALUES, variables, depth + 1) for key, value in values.items() if value},
        {key: _row(saved.inputs.get(key, {}), variables, depth + 1) for key in shape.rows},
    )


def _branches(saved: _Saved) -> Shape:
    """Return the shape of an `if`; with fewer inputs than branches it has a gap."""
    more = msgspec.convert(saved.extraState.get("elseIfCount", 0), int)
    numbers = range(1 + min(more, len(saved.inputs)))
    return Shape(
        {}, tuple(f"IF{number}" for number in numbers), (*(f"DO{number}" for number in numbers), "ELSE")
    )


def _field(saved: _Saved, key: str, words: Iterable[str], variables: Mapping[str, str]) -> str:
    """Return the value of a field; of a variable its id, of a number its text in Python."""
    found = saved.fields.get(key)
    if key == "NUM":
        number = msgspec.convert(found, float)
        if abs(number) > LARGEST:
            raise too_large(saved.id)
        return str(int(number)) if number.is_integer() else repr(number)
    if key == "VAR":
        found, words = msgspec.convert(found, _Table).get("id"), variables
    own = key == "NAME" and isinstance(found, str) and own_gestures.possible(found)
    if not isinstance(found, str) or (found not in words and not own):
        raise wrong("format", saved.id)
    return found
