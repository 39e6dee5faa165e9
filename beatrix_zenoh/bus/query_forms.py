"""Decoding of queries in their four forms: msgpack, JSON, plain words, selector parameters."""

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
from beatrix_zenoh.contract.errors import QUOTED, Refused, quoted
from beatrix_zenoh.contract.refusals import COMMANDS, bad_field

M = TypeVar("M", bound=msgspec.Struct)

SWITCH = {"on": "true", "off": "false"}
MODES = {"absolute": "true", "relative": "false"}
AXES: Final = ("x", "y", "z")
ANGLES: Final = ("yaw", "pitch", "roll")
SPEEDS: Final = tuple(f"speed_{axis}" for axis in AXES)
OTHER_FORMS: Final[dict[type[msgspec.Struct], str]] = {
    FollowQuery: 'Send `on` or `off`, parameters `?follow=true`, JSON {"follow":true} or msgpack.',
    NoteQuery: 'Send the text, parameters `?text=trial%203`, JSON {"text":"trial 3"} or msgpack.',
    SoundQuery: 'Send words `noise 3` (a sound and its seconds) or `x y z`, parameters `?play=noise;x=1.0;y=0.5;z=0.1`, JSON {"play":"noise"} or msgpack; m, s.',
    TargetQuery: 'Send words `x y z` or `sway 12` (a path and its period), parameters `?x=1.1;y=0.3;z=0.2`, JSON {"x":1.1,"y":0.3,"z":0.2} or msgpack; m.',
}
"""Forms of requests that name no angle of the arms or the head."""
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
        raise Refused(
            Reason.BAD_VALUE,
            f"The payload is neither text nor marked as msgpack (encoding {codec.MSGPACK}). {usage(kind)}",
        ) from error
    if text.startswith(("{", "[")):
        return _with_angle(codec.decode_json(text.encode(), kind), raw)
    if text:
        return codec.from_words(_nested(_words(text, kind), kind), kind)
    parameters = _parameters(raw.parameters)
    if not parameters:
        raise Refused(Reason.BAD_VALUE, f"Empty query. {usage(kind)}")
    return _with_angle(codec.from_words(_nested(parameters, kind), kind), raw)


def read_motion_or_pose(raw: RawQuery) -> MotionQuery | PoseQuery:
    """Decode a motion or a pose, depending on the names of its fields; raises the errors of `read`."""
    _check_length(raw)
    if raw.payload and not raw.binary and not raw.payload.lstrip().startswith(b"{"):
        raise Refused(
            Reason.BAD_VALUE,
            "Plain words do not show whether they are for the arms or the head. Send parameters: ?x=0.1;y=0;z=0 for the "
            "arms or ?yaw=0.3 for the head (rad).",
        )
    motion = _field_names(raw) & {"position", *AXES, *SPEEDS}
    return read(raw, MotionQuery) if motion else read(raw, PoseQuery)


def _check_length(raw: RawQuery) -> None:
    """Raise Refused (BAD_VALUE) for a request so long that decoding it would delay other requests."""
    length = max(len(raw.payload), len(raw.parameters))
    if length > LENGTH_MAX:
        raise Refused(Reason.BAD_VALUE, f"The request has {length} bytes; at most {LENGTH_MAX} are allowed.")


def usage(kind: type[msgspec.Struct]) -> str:
    """Return a sentence that explains the forms of a request of this kind."""
    if kind is MotionQuery:
        return (
            "Send words `x y z [speed | sx sy sz] [relative]`, parameters `?x=0.1;y=0;z=0;speed=0.5;absolute=true` (or "
            '`speed_x=0.5;speed_y=0.4;speed_z=0.3`), JSON {"position":{"x":0.1,"y":0,"z":0}} or msgpack; rad and rad/s '
            "(10 degrees = 0.1745 rad)."
        )
    if kind is PoseQuery:
        return (
            "Send words `yaw pitch roll [speed] [relative]`, parameters `?yaw=0.3;pitch=-0.1`, "
            'JSON {"yaw":0.3} or msgpack; rad and rad/s (10 degrees = 0.1745 rad).'
        )
    if kind is CommandQuery:
        names = ", ".join(f"{command.value} {command.name.lower()}" for command in Command)
        forms = 'Send `enable on`, `disable`, parameters `?command=2` or JSON {"command":1,"value":true}.'
        return f"{forms} Commands: {names}."
    if kind is LeaseQuery:
        actions = ", ".join(action.value for action in LeaseAction)
        return (
            'Send one word, parameters `?action=take` or JSON {"action":"take"}; `limit 0.5` limits the speed, rad/s. '
            f"Words: {actions}."
        )
    return OTHER_FORMS.get(kind) or f"Its fields: {codec.outline(kind)}."


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


def _words(text: str, kind: type[msgspec.Struct]) -> dict[str, str]:
    """Return the parameters, by name, of a request that is written in plain words."""
    if kind is NoteQuery:
        return {"text": text}
    words = text.replace(",", " ").split()
    if kind is not CommandQuery:
        words = [word.lower() for word in words]
    modes = [MODES[word] for word in words if word in MODES]
    if len(modes) > 1:
        raise bad_field(
            "absolute", f"{quoted(text)} is ambiguous: write absolute or relative, once. {usage(kind)}"
        )
    values = [word for word in words if word not in MODES]
    names = _names_of(len(values), kind)
    if names is None:
        raise Refused(
            Reason.BAD_VALUE, f"{kind.__name__}: {len(values)} is the wrong number of words. {usage(kind)}"
        )
    fields = {"absolute": modes[0]} if modes else {}
    return fields | dict(zip(names, values, strict=True))


def _names_of(count: int, kind: type[msgspec.Struct]) -> tuple[str, ...] | None:
    """Return the names of the parameters that `count` words stand for; None if no request has that many words."""
    if kind is CommandQuery:
        return {1: ("command",), 2: ("command", "value")}.get(count)
    if kind is LeaseQuery:
        return {1: ("action",), 2: ("action", "speed")}.get(count)
    if kind is FollowQuery:
        return ("follow",) if count == 1 else None
    if kind is SoundQuery:
        return {1: ("play",), 2: ("play", "seconds"), 3: AXES}.get(count)
    if kind is TargetQuery:
        return {1: ("path",), 2: ("path", "period_s"), 3: AXES}.get(count)
    angles = AXES if kind is MotionQuery else ANGLES
    forms = {3: angles, 4: (*angles, "speed")}
    if kind is MotionQuery:
        forms[6] = angles + SPEEDS
    return forms.get(count)


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
