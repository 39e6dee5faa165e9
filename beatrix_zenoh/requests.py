"""The four ways to word a query: msgpack, JSON, plain words, selector parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar
from urllib.parse import unquote

import msgspec

from beatrix_zenoh import codec
from beatrix_zenoh._generated.messages import Command, CommandQuery, MotionQuery, PoseQuery, Reason
from beatrix_zenoh.errors import Refused, quoted

M = TypeVar("M", bound=msgspec.Struct)

SWITCH = {"on": "true", "off": "false"}
MODES = {"absolute": "true", "relative": "false"}


@dataclass(frozen=True)
class Wording:
    """A query as it arrived: payload, its encoding and the selector's parameters."""

    payload: bytes
    encoding: str
    parameters: str

    @property
    def binary(self) -> bool:
        """Asked in msgpack, so to be answered in msgpack; everything else gets JSON text."""
        return self.encoding.startswith(codec.MSGPACK)

    def answer(self, message: msgspec.Struct) -> tuple[bytes, str]:
        """Payload and encoding of an answer in kind."""
        if self.binary:
            return codec.encode(message), codec.MSGPACK
        return codec.encode_json(message), codec.JSON


def read(wording: Wording, kind: type[M]) -> M:
    """Understand a query.

    Raises:
        Refused: BAD_VALUE, naming the field, what is allowed and how to ask.
    """
    if wording.payload and (twice := _parameters(wording.parameters)):
        raise Refused(
            Reason.BAD_VALUE,
            f"The payload says what is asked, so leave out the parameters {', '.join(map(quoted, twice))}. {usage(kind)}",
        )
    if wording.binary:
        return codec.decode(wording.payload, kind)
    try:
        text = wording.payload.decode().strip()
    except UnicodeDecodeError as error:
        raise Refused(
            Reason.BAD_VALUE,
            f"The payload is neither text nor marked as msgpack (encoding {codec.MSGPACK}). {usage(kind)}",
        ) from error
    if text.startswith(("{", "[")):
        return codec.decode_json(text.encode(), kind)
    if text:
        return codec.from_words(_shaped(_words(text, kind), kind), kind)
    parameters = _parameters(wording.parameters)
    if not parameters:
        raise Refused(Reason.BAD_VALUE, f"Empty query. {usage(kind)}")
    return codec.from_words(_shaped(parameters, kind), kind)


def read_motion_or_pose(wording: Wording) -> MotionQuery | PoseQuery:
    """Understand a query that may hold either, told apart by its field names; raises as `read`."""
    if wording.payload and (wording.binary or wording.payload.lstrip().startswith(b"{")):
        names = codec.field_names(wording.payload, json=not wording.binary)
    elif wording.payload:
        raise Refused(
            Reason.BAD_VALUE,
            "Plain words do not say whether arms or head are meant: ask with parameters, "
            "?x=0.1;y=0;z=0 for the arms or ?yaw=0.3 for the head (rad).",
        )
    else:
        names = frozenset(_parameters(wording.parameters))
    motion = names & {"position", "x", "y", "z"}
    return read(wording, MotionQuery) if motion else read(wording, PoseQuery)


def usage(kind: type[msgspec.Struct]) -> str:
    """How to word a request of this kind, for people at a command line."""
    if kind is MotionQuery:
        return (
            "Ask with words `x y z [speed] [relative]`, parameters `?x=0.1;y=0;z=0;speed=0.5;absolute=true`, "
            'JSON {"position":{"x":0.1,"y":0,"z":0}} or msgpack; rad and rad/s (10 degrees = 0.1745 rad).'
        )
    if kind is PoseQuery:
        return (
            "Ask with words `yaw pitch roll [speed] [relative]`, parameters `?yaw=0.3;pitch=-0.1`, "
            'JSON {"yaw":0.3} or msgpack; rad and rad/s (10 degrees = 0.1745 rad).'
        )
    if kind is CommandQuery:
        names = ", ".join(f"{command.value} {command.name.lower()}" for command in Command)
        ways = 'Ask with `enable on`, `disable`, parameters `?command=2` or JSON {"command":1,"value":true}.'
        return f"{ways} Commands: {names}."
    return f"It holds: {codec.outline(kind)}."


def _words(text: str, kind: type[msgspec.Struct]) -> dict[str, str]:
    words = text.replace(",", " ").split()
    if kind is CommandQuery:
        names = ["command", "value"]
    else:
        names = (["x", "y", "z"] if kind is MotionQuery else ["yaw", "pitch", "roll"]) + ["speed"]
        words = [word.lower() for word in words]
    modes = [MODES[word] for word in words if word in MODES]
    if len(modes) > 1:
        raise Refused(Reason.BAD_VALUE, f"{quoted(text)}: say absolute or relative, once. {usage(kind)}")
    fields = {"absolute": modes[-1]} if modes else {}
    values = [word for word in words if word not in MODES]
    if not values or len(values) > len(names) or (kind is not CommandQuery and len(values) < 3):
        raise Refused(
            Reason.BAD_VALUE, f"{kind.__name__}: {len(values)} words where {names} are due. {usage(kind)}"
        )
    return fields | dict(zip(names, values, strict=False))


def _parameters(text: str) -> dict[str, str]:
    fields: dict[str, str] = {}
    for part in filter(None, text.split(";")):
        name, _, value = part.partition("=")
        if "&" in part:
            raise Refused(Reason.BAD_VALUE, f"{quoted(part)}: put ; between parameters, not &.")
        if not name.startswith("_"):  # zenoh's own parameters begin with an underscore
            if unquote(name) in fields:
                raise Refused(Reason.BAD_VALUE, f"{quoted(unquote(name))} is given twice: give it once.")
            fields[unquote(name)] = unquote(value)
    return fields


def _shaped(flat: dict[str, str], kind: type[msgspec.Struct]) -> dict[str, object]:
    """Flat names to the message's shape: x, y, z into position, one speed for all arms."""
    fields: dict[str, object] = dict(flat)
    if kind is MotionQuery:
        if "position" in fields:
            raise Refused(
                Reason.BAD_VALUE, f"'position' is no parameter: its parts x, y, z are. {usage(kind)}"
            )
        position = {axis: fields.pop(axis) for axis in ("x", "y", "z") if axis in fields}
        fields["position"] = position
        if "speed" in fields:
            fields["speed"] = dict.fromkeys(("x", "y", "z"), fields["speed"])
    elif kind is CommandQuery:
        name = str(fields.get("command", "")).upper()
        if name == "DISABLE":
            if "value" in fields:
                raise Refused(Reason.BAD_VALUE, f"disable takes no value. {usage(kind)}")
            name, fields["value"] = "ENABLE", "false"
        if name in Command.__members__:
            fields["command"] = Command[name].value
        elif name[:1].isalpha():
            raise Refused(
                Reason.UNKNOWN_COMMAND, f"There is no command {quoted(name.lower())}. {usage(kind)}"
            )
        fields["value"] = SWITCH.get(str(fields.get("value", "true")).lower(), fields.get("value", "true"))
    return fields
