"""Python side of the serial link and of the robot: beatrix_zenoh/contract/_generated/{serial,robot}.py."""

from __future__ import annotations

from contract import Contract, rows
from emit_python import HEADER, doc_of

IN_FIRMWARE = ("heartbeat_timeout", "text_start", "text_motion")
"""Constants of the link that no host needs."""
BARE = ("ACK", "SET_NAME")
"""Frames with one field, which hosts read and write as bytes."""
REPLIES = 0x80
"""Types of frames of the host are smaller."""
STRUCT = {"u8": "B", "u16": "H", "u32": "I", "i16": "h", "i32": "i"}


def frame_class(name: str, table: dict[str, object]) -> str:
    layout, counts = "<", list[int]()
    fields = ""
    for field in list(table["fields"]):  # type: ignore[call-overload]
        count, kind = int(field.get("count", 1)), str(field["type"])
        python, doc = "bytes", doc_of(field)
        if kind == "text":
            doc += f"; at most {count} bytes"
        elif kind == "char":
            layout += f"{count}s"
            counts.append(1)
        else:
            layout += (f"{count}" if count > 1 else "") + STRUCT[kind]
            counts.append(count)
            python = f"tuple[{', '.join(['int'] * count)}]" if count > 1 else "int"
        fields += f'    {field["name"]}: {python}\n    """{doc}"""\n'
    request = (
        f"    kind: ClassVar[FrameType] = FrameType.{name}\n" if int(str(table["type"])) < REPLIES else ""
    )
    return (
        f'class {name.title().replace("_", "")}(Frame, frozen=True):\n    """{table["doc"]}"""\n\n'
        f"{request}    layout = struct.Struct({layout!r})\n    counts = {tuple(counts)}\n{fields}"
    )


def codes(title: str, key: str, rows: dict[str, dict[str, object]]) -> str:
    out = f'\n\nclass {title}(Code):\n    """Codes of `{key}`."""\n\n'
    if any("reason" in row for row in rows.values()):
        out += "    reason: Reason\n\n"
    for name, row in rows.items():
        reason = f", Reason.{row['reason']}" if "reason" in row else ""
        out += f"    {name} = {row['code']}, {row['doc']!r}{reason}\n"
    return out


def serial(contract: Contract) -> str:
    table = contract.serial
    out = HEADER.format(doc="Serial link between host and firmware.", source="serial.toml")
    out += "import struct\nfrom enum import IntEnum, IntFlag\nfrom typing import ClassVar, Final\n\n"
    out += "from beatrix_zenoh.contract._generated.messages import Reason\n"
    out += "from beatrix_zenoh.contract.rows import Code, Frame\n\n"
    out += f'CONTRACT: Final = 0x{contract.serial_hash:08X}\n"""Hash of the serial contract and of the robot values in the firmware, compared in HELLO."""\n'
    for name, row in table["link"].items():
        if name in IN_FIRMWARE:
            continue
        out += f'{name.upper()}: Final = {row["value"]}\n"""{doc_of(row)}"""\n'
    for title, key in (("Error", "error"), ("BoardOutcome", "outcome"), ("WarningCode", "warning")):
        out += codes(title, key, table[key])
    out += '\n\nclass BoardState(IntFlag):\n    """State bits of TELEMETRY."""\n\n'
    out += "".join(
        f'    {n} = {1 << int(str(r["bit"]))}\n    """{r["doc"]}"""\n' for n, r in table["state"].items()
    )
    out += "\n    __and__ = __rand__ = int.__and__  # type: ignore[assignment] # quick: IntFlag makes a member each time\n"
    out += '\n\nclass FrameType(IntEnum):\n    """First byte of a frame."""\n\n'
    out += "".join(f'    {n} = 0x{r["type"]:02X}\n    """{r["doc"]}"""\n' for n, r in table["frame"].items())
    frames = {name: frame for name, frame in table["frame"].items() if "fields" in frame and name not in BARE}
    return out + "".join("\n\n" + frame_class(name, frame) for name, frame in frames.items())


def python_value(value: object) -> tuple[str, str]:
    """Return the type and the literal of a robot value as Python source."""
    if isinstance(value, list):
        kind = type(value[0]).__name__
        return f"tuple[{', '.join([kind] * len(value))}]", repr(tuple(value))
    return type(value).__name__, repr(value)


def field_type(group: str, row: dict[str, object]) -> str:
    """Return the type of a robot value as Python source, with its range if a robot file may change it."""
    kind, _ = python_value(row["value"])
    if group in FIXED or not ("min" in row or "max" in row):
        return kind
    return f"Annotated[{kind}, Range({row.get('min', '-inf')}, {row.get('max', 'inf')}, {row['unit']!r})]"


FIXED = ("sizes", "colours")
"""Tables of robot.toml that no robot file changes."""


def robot(contract: Contract) -> str:
    out = HEADER.format(doc="The robot as it ships.", source="robot.toml")
    out += "from math import inf\nfrom typing import Annotated, Final\n\nfrom msgspec import Struct\n\n"
    out += "from beatrix_zenoh.contract.rows import Range, ranges\n"
    for group, table in contract.robot.items():
        out += f'\n\nclass {group.title()}Data(Struct, frozen=True, forbid_unknown_fields=True):\n    """{table["doc"]}"""\n\n'
        for name, row in rows(table).items():
            _, literal = python_value(row["value"])
            out += f'    {name}: {field_type(group, row)} = {literal}\n    """{doc_of(row)}; {row["source"]}"""\n'
    out += '\n\nclass RobotData(Struct, frozen=True, forbid_unknown_fields=True):\n    """All values of robot.toml, in its units."""\n\n'
    out += "".join(
        f"    {g}: {g.title()}Data = {g.title()}Data()\n" for g in contract.robot if g not in FIXED
    )
    out += '\n\nROBOT: Final = RobotData()\n"""The shipped robot."""\n'
    out += "".join(f"{group.upper()}: Final = {group.title()}Data()\n" for group in FIXED)
    return out + (
        'ALLOWED: Final = ranges(RobotData)\n"""Ranges of the fields that a robot file may change, by table."""\n'
    )


def files(contract: Contract) -> dict[str, str]:
    """Return the text of every generated Python file by its relative path."""
    base = "beatrix_zenoh/contract/_generated/"
    return {base + "serial.py": serial(contract), base + "robot.py": robot(contract)}
