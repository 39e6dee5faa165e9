"""Python side of the serial link and of the robot: beatrix_zenoh/contract/_generated/{serial,robot}.py."""

from __future__ import annotations

from contract import Contract, rows
from emit_python import HEADER, doc_of

STRUCT = {"u8": "B", "u16": "H", "u32": "I", "i16": "h", "i32": "i"}


def frame_class(name: str, table: dict[str, object]) -> str:
    fields: list[dict[str, object]] = list(table.get("fields", []))  # type: ignore[call-overload]
    layout = "<"
    lines = [f"class {name.title().replace('_', '')}(NamedTuple):", f'    """{table["doc"]}"""', ""]
    pack, unpack, at = [], [], 0
    const, tail = f"_{name}", ""
    for field in fields:
        if field["type"] == "text":
            tail = str(field["name"])
            lines += [f"    {tail}: bytes", f'    """{doc_of(field)}; at most {field["count"]} bytes"""']
            continue
        count, kind = int(str(field.get("count", 1))), str(field["type"])
        layout += f"{count}s" if kind == "char" else (f"{count}" if count > 1 else "") + STRUCT[kind]
        if kind == "char":
            python, pack_one, unpack_one, used = "bytes", f"self.{field['name']}", f"values[{at}]", 1
        elif count > 1:
            python = f"tuple[{', '.join(['int'] * count)}]"
            pack_one = f"*self.{field['name']}"
            unpack_one = "(" + ", ".join(f"values[{at + k}]" for k in range(count)) + ")"
            used = count
        else:
            python, pack_one, unpack_one, used = "int", f"self.{field['name']}", f"values[{at}]", 1
        lines += [f"    {field['name']}: {python}", f'    """{doc_of(field)}"""']
        pack.append(pack_one)
        unpack.append(unpack_one)
        at += used
    lines += [
        "",
        "    @property",
        "    def kind(self) -> FrameType:",
        '        """Frame type, the first byte of the frame."""',
        f"        return FrameType.{name}",
        "",
        "    def pack(self) -> bytes:",
        '        """Return the payload, without type, seq and checksum."""',
    ]
    lines += [f"        return {const}.pack({', '.join(pack)})" + (f" + self.{tail}" if tail else "")]
    lines += [
        "",
        "    @classmethod",
        f"    def unpack(cls, payload: bytes) -> {name.title().replace('_', '')}:",
    ]
    lines += ['        """Return the fields of a payload; raises struct.error if its length is wrong."""']
    fixed = f"payload[: {const}.size]" if tail else "payload"
    unpack += [f"payload[{const}.size :]"] if tail else []
    lines += [f"        values = {const}.unpack({fixed})", f"        return cls({', '.join(unpack)})"]
    before = f" before its {tail}" if tail else ""
    size = f'{name}_SIZE: Final = {const}.size\n"""Payload bytes of {name}{before}."""\n'
    return f'{const}: Final = Struct("{layout}")\n{size}\n\n' + "\n".join(lines)


def serial(contract: Contract) -> str:
    table = contract.serial
    out = HEADER.format(doc="Serial link between host and firmware.", source="serial.toml")
    out += "from enum import IntEnum, IntFlag\nfrom struct import Struct\nfrom typing import Final, NamedTuple\n\n"
    out += "from beatrix_zenoh.contract._generated.messages import Reason\n\n"
    out += f'CONTRACT: Final = 0x{contract.serial_hash:08X}\n"""Hash of the serial contract and of the robot values in the firmware, compared in HELLO."""\n'
    for name, row in table["link"].items():
        out += f'{name.upper()}: Final = {row["value"]}\n"""{doc_of(row)}"""\n'
    for title, key in (("Error", "error"), ("BoardOutcome", "outcome")):
        out += f'\n\nclass {title}(IntEnum):\n    """Codes of `{key}`."""\n\n'
        out += "".join(f'    {n} = {r["code"]}\n    """{r["doc"]}"""\n' for n, r in table[key].items())
        out += f"\n\n{key.upper()}_REASON: Final[dict[{title}, Reason]] = {{\n"
        out += "".join(f"    {title}.{n}: Reason.{r['reason']},\n" for n, r in table[key].items()) + "}\n"
        out += f"\n\n{key.upper()}_TEXT: Final[dict[{title}, str]] = {{\n"
        out += "".join(f"    {title}.{n}: {r['doc']!r},\n" for n, r in table[key].items()) + "}\n"
    out += '\n\nclass WarningCode(IntEnum):\n    """Codes of `warning`."""\n\n'
    out += "".join(f'    {n} = {r["code"]}\n    """{r["doc"]}"""\n' for n, r in table["warning"].items())
    out += "\n\nWARNING_TEXT: Final[dict[WarningCode, str]] = {\n"
    out += "".join(f"    WarningCode.{n}: {r['doc']!r},\n" for n, r in table["warning"].items()) + "}\n"
    out += '\n\nclass BoardState(IntFlag):\n    """State bits of TELEMETRY."""\n\n'
    out += "".join(
        f'    {n} = {1 << int(str(r["bit"]))}\n    """{r["doc"]}"""\n' for n, r in table["state"].items()
    )
    out += "\n    __and__ = __rand__ = int.__and__  # type: ignore[assignment] # quick: IntFlag makes a member each time\n"
    out += '\n\nclass FrameType(IntEnum):\n    """First byte of a frame."""\n\n'
    out += "".join(f'    {n} = 0x{r["type"]:02X}\n    """{r["doc"]}"""\n' for n, r in table["frame"].items())
    for name, frame in table["frame"].items():
        if "fields" in frame:
            out += "\n\n" + frame_class(name, frame) + "\n"
    return out


def python_value(value: object) -> tuple[str, str]:
    """Return the type and the literal of a robot value as Python source."""
    if isinstance(value, list):
        kind = type(value[0]).__name__
        return f"tuple[{', '.join([kind] * len(value))}]", repr(tuple(value))
    return type(value).__name__, repr(value)


def robot_ranges(contract: Contract) -> str:
    """Return the Python source of the ranges of the fields that a robot file may change."""
    out = '\n\nclass Range(NamedTuple):\n    """Range of a field in a robot file; a bound is infinite if another value or the firmware limits the field."""\n\n'
    out += "    low: float\n    high: float\n    unit: str\n"
    out += "\n\nALLOWED: Final[dict[str, dict[str, Range]]] = {\n"
    for group, table in contract.robot.items():
        if group in FIXED:
            continue
        ranges = {
            name: f"Range({row.get('min', '-inf')}, {row.get('max', 'inf')}, {row['unit']!r})"
            for name, row in rows(table).items()
            if "min" in row or "max" in row
        }
        out += f"    {group!r}: {{" + "".join(f"{name!r}: {text}, " for name, text in ranges.items()) + "},\n"
    return out + '}\n"""Ranges of the fields that a robot file may change, by table."""\n'


FIXED = ("sizes", "colours")
"""Tables of robot.toml that no robot file changes."""


def robot(contract: Contract) -> str:
    out = HEADER.format(doc="The robot as it ships.", source="robot.toml")
    out += "from math import inf\nfrom typing import Final, NamedTuple\n\nfrom msgspec import Struct\n"
    for group, table in contract.robot.items():
        out += f'\n\nclass {group.title()}Data(Struct, frozen=True, forbid_unknown_fields=True):\n    """{table["doc"]}"""\n\n'
        for name, row in rows(table).items():
            kind, literal = python_value(row["value"])
            out += f'    {name}: {kind} = {literal}\n    """{doc_of(row)}; {row["source"]}"""\n'
    out += '\n\nclass RobotData(Struct, frozen=True, forbid_unknown_fields=True):\n    """All values of robot.toml, in its units."""\n\n'
    out += "".join(
        f"    {g}: {g.title()}Data = {g.title()}Data()\n" for g in contract.robot if g not in FIXED
    )
    out += '\n\nROBOT: Final = RobotData()\n"""The shipped robot."""\n'
    out += "".join(f"{group.upper()}: Final = {group.title()}Data()\n" for group in FIXED)
    return out + robot_ranges(contract)


def files(contract: Contract) -> dict[str, str]:
    """Return the text of every generated Python file by its relative path."""
    base = "beatrix_zenoh/contract/_generated/"
    return {base + "serial.py": serial(contract), base + "robot.py": robot(contract)}
