"""Decoding of queries in their three forms: msgpack, JSON, selector parameters."""

from __future__ import annotations

import codecs
import re
from typing import Final, TypeVar
from urllib.parse import unquote

import msgspec

from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import (
    Command,
    CommandQuery,
    Detail,
    FollowQuery,
    LeaseAction,
    LeaseQuery,
    MotionQuery,
    NoteQuery,
    PoseQuery,
    Reason,
    SoundQuery,
    TargetQuery,
)
from beatrix_zenoh.contract.errors import QUOTED, Refused, bad_value, quoted
from beatrix_zenoh.contract.refusals import COMMANDS, bad_field

M = TypeVar("M", bound=msgspec.Struct)

SWITCH = {"on": "true", "off": "false"}
AXES: Final = ("x", "y", "z")
ANGLES: Final = ("yaw", "pitch", "roll")
SPEEDS: Final = tuple(f"speed_{axis}" for axis in AXES)
USAGES: Final[dict[type[msgspec.Struct], str]] = {
    MotionQuery: "Send parameters `?x=0.1;y=0;z=0;speed=0.5;absolute=true` (or `speed_x=0.5;speed_y=0.4;speed_z=0.3`), JSON "
    '{"position":{"x":0.1,"y":0,"z":0}} or msgpack; rad and rad/s (10 degrees = 0.1745 rad).',
    PoseQuery: 'Send parameters `?yaw=0.3;pitch=-0.1;speed=0.5;absolute=true`, JSON {"yaw":0.3} or msgpack; rad and rad/s '
    "(10 degrees = 0.1745 rad).",
    CommandQuery: "Send parameters `?command=enable` or `?command=1;value=off`, or JSON "
    '{"command":1,"value":true}. Commands: '
    f"{', '.join(f'{command.value} {command.name.lower()}' for command in Command)}.",
    LeaseQuery: 'Send parameters `?action=take` or JSON {"action":"take"}; `?action=limit;speed=0.5` limits the speed, '
    f"rad/s. Actions: {', '.join(action.value for action in LeaseAction)}.",
    FollowQuery: 'Send parameters `?follow=on`, JSON {"follow":true} or msgpack.',
    NoteQuery: 'Send parameters `?text=trial%203`, JSON {"text":"trial 3"} or msgpack.',
    SoundQuery: 'Send parameters `?play=noise;seconds=3;x=1.0;y=0.5;z=0.1`, JSON {"play":"noise"} or msgpack; m, s.',
    TargetQuery: 'Send parameters `?x=1.1;y=0.3;z=0.2` or `?path=sway;period_s=12`, JSON {"x":1.1,"y":0.3,"z":0.2} or msgpack; m.',
}
"""The forms of requests, by their kinds."""
LENGTH_MAX: Final = 4096
"""Longest payload (bytes) and longest parameters (characters); requests have about two hundred."""
_NUMBER: Final = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
"""Numbers as people write them, including `5.`, `.5` and `+0.5`; the match takes linear time."""


class RawQuery(msgspec.Struct, frozen=True):
    """A query before decoding: payload, its encoding and the parameters of its selector."""

    payload: bytes
    encoding: str
    parameters: str

    def __post_init__(self) -> None:
        """Remove the byte order mark, with which PowerShell and editors of Windows begin a text."""
        if not self.binary:
            msgspec.structs.force_setattr(self, "payload", self.payload.removeprefix(codecs.BOM_UTF8))

    @property
    def binary(self) -> bool:
        """Whether the query is msgpack; the reply is then msgpack, too, otherwise JSON text."""
        return self.encoding.startswith(codec.MSGPACK)

    def answer(self, message: msgspec.Struct) -> tuple[bytes, str]:
        """Return payload and encoding of a reply in the form of the query."""
        if self.binary:
            return codec.encode(message), codec.MSGPACK
        return codec.encode_json(message), codec.JSON


def read(raw: RawQuery, kind: type[M]) -> M:
    """Decode a query.

    Raises:
        Refused: BAD_VALUE or UNKNOWN_COMMAND, with the field, the allowed values and the usage.
    """
    _check_length(raw)
    if raw.payload and (parameters := _parameters(raw.parameters)):
        names = ", ".join(map(quoted, parameters))
        raise bad_field(
            next(iter(parameters))[:QUOTED],
            f"The payload is the request; leave out the parameters {names}. {usage(kind)}",
        )
    if raw.binary:
        return _with_angle(codec.decode(raw.payload, kind), raw)
    try:
        text = raw.payload.decode().strip()
    except UnicodeDecodeError as error:
        raise bad_value(
            f"The payload is neither text nor marked as msgpack (encoding {codec.MSGPACK}). {usage(kind)}",
        ) from error
    if text.startswith(("{", "[")):
        return _with_angle(codec.decode_json(text.encode(), kind), raw)
    if text:
        raise bad_value(f"The payload {quoted(text[:QUOTED])} is no JSON. {usage(kind)}")
    parameters = _parameters(raw.parameters)
    if not parameters:
        raise bad_value(f"Empty query. {usage(kind)}")
    return _with_angle(codec.from_text(_nested(parameters, kind), kind), raw)


def read_motion_or_pose(raw: RawQuery) -> MotionQuery | PoseQuery:
    """Decode a motion or a pose, depending on the names of its fields; raises the errors of `read`."""
    _check_length(raw)
    motion = _field_names(raw) & {"position", *AXES, *SPEEDS}
    return read(raw, MotionQuery) if motion else read(raw, PoseQuery)


def _check_length(raw: RawQuery) -> None:
    """Raise Refused (BAD_VALUE) for a request so long that decoding it would delay other requests."""
    length = max(len(raw.payload), len(raw.parameters))
    if length > LENGTH_MAX:
        raise bad_value(f"The request has {length} bytes; at most {LENGTH_MAX} are allowed.")


def usage(kind: type[msgspec.Struct]) -> str:
    """Return a sentence that explains the forms of a request of this kind."""
    return USAGES.get(kind) or f"Its fields: {codec.outline(kind)}."


def _with_angle(message: M, raw: RawQuery) -> M:
    """Return the message; raise Refused for a PoseQuery without an angle, which would be the home pose."""
    if isinstance(message, PoseQuery) and not (message.yaw or message.pitch or message.roll):
        names = _field_names(raw)
        if not names.intersection(ANGLES):
            raise bad_field(
                "yaw", f"A pose needs at least one of yaw, pitch and roll. {usage(PoseQuery)}", ANGLES
            )
    return message


def _field_names(raw: RawQuery) -> frozenset[str]:
    if raw.payload:
        return codec.field_names(raw.payload, json=not raw.binary)
    return frozenset(_parameters(raw.parameters))


def _parameters(text: str) -> dict[str, str]:
    fields: dict[str, str] = {}
    for part in filter(None, text.split(";")):
        encoded, _, value = part.partition("=")
        name = unquote(encoded)
        if "&" in part:
            raise bad_field(name[:QUOTED], f"{quoted(part)}: put ; between parameters, not &.")
        if not encoded.startswith("_"):  # parameters of Zenoh itself begin with an underscore
            if name in fields:
                raise bad_field(name[:QUOTED], f"{quoted(name)} is given twice. Give it once.")
            fields[name] = unquote(value)
    return fields


def _nested(flat: dict[str, str], kind: type[msgspec.Struct]) -> dict[str, object]:
    """Return parameters in the structure of the message: x, y, z inside `position`, text converted to numbers."""
    if kind is CommandQuery:
        return _command(flat)
    if kind is FollowQuery:
        return {name: SWITCH.get(value.lower(), value) for name, value in flat.items()}
    fields: dict[str, object] = {
        name: value if name in ("absolute", "source") else _number(value) for name, value in flat.items()
    }
    if kind is MotionQuery:
        if "position" in fields:
            raise bad_field("position", f"'position' is not a parameter; x, y and z are. {usage(kind)}", AXES)
        fields["position"] = {axis: fields.pop(axis) for axis in AXES if axis in fields}
        each = {axis: fields.pop(name) for axis, name in zip(AXES, SPEEDS, strict=True) if name in fields}
        if "speed" in fields:
            if each:
                raise bad_field(
                    "speed", f"Give speed or {', '.join(SPEEDS)}, not both. {usage(kind)}", SPEEDS
                )
            fields["speed"] = dict.fromkeys(AXES, fields["speed"])
        elif each:
            fields["speed"] = each
    return fields


def _number(text: str) -> float | str:
    """Convert a number; return any other text unchanged: the decoder refuses it with the name of the field."""
    return float(text) if _NUMBER.fullmatch(text) else text


def _command(flat: dict[str, str]) -> dict[str, object]:
    """Return the fields of a CommandQuery from the command's name or number."""
    fields: dict[str, object] = dict(flat)
    name = flat.get("command", "").upper()
    if name == "DISABLE":
        if "value" in flat:
            raise bad_field("value", f"disable takes no value. {usage(CommandQuery)}")
        name, fields["value"] = "ENABLE", "false"
    if name in Command.__members__:
        fields["command"] = Command[name].value
    elif name[:1].isalpha():
        raise Refused(Reason.UNKNOWN_COMMAND, detail=Detail(field=name.lower()[:QUOTED], known=COMMANDS))
    value = str(fields.get("value", "true"))
    fields["value"] = SWITCH.get(value.lower(), value)
    return fields
