"""The streams of a robot by name, from the table of keys: a new row in schemas/keys.toml is a stream of all verbs."""

from __future__ import annotations

import re
from typing import cast

import msgspec

from beatrix_zenoh.bus import Reply
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.subscription import (
    FIRST_PICTURE_S,
    SILENCE_S,
    Reader,
    Sample,
    Subscription,
    images,
    message,
    same,
)
from beatrix_zenoh.contract import codec, names
from beatrix_zenoh.contract._generated import keys, messages
from beatrix_zenoh.contract._generated.keys import KeyRow

BASE = "beatrix/{robot}/{side}/state/"
CAMERA = "camera/"
QUEUE = 100
"""Length of the queue for pictures."""


def streams() -> dict[str, KeyRow]:
    """Return the publications of a robot by name, such as `positions` or `camera/left`, without those in JSON."""
    found = {row.key.removeprefix(BASE): row for row in keys.KEYS.values() if row.key.startswith(BASE)}
    return {
        name.replace("{eye}", view): row
        for name, row in found.items()
        for view in (names.VIEWS if "{eye}" in name else names.VIEWS[:1])
        if not name.endswith("/json")
    }


def periodic() -> list[str]:
    """Return the names of the streams whose rate and losses can be measured: with numbers, at a constant rate or media."""
    return [
        name
        for name, row in streams().items()
        if (row.rate_hz or row.publish == "media") and "seq" in header(row).__struct_fields__
    ]


def header(row: KeyRow) -> type[msgspec.Struct]:
    """Return the message of a stream, or the one in the attachment of its bytes."""
    kinds = (getattr(messages, word, None) for word in re.findall(r"\w+", row.payload))
    return next(kind for kind in kinds if isinstance(kind, type) and issubclass(kind, msgspec.Struct))


def stream(client: Client, name: str, robot: str, side: str) -> Subscription[object]:
    """Subscribe to the messages of a stream: to pictures with their data, to sound by its headers alone.

    Raises the errors of `images`.
    """
    if name.startswith(CAMERA):
        eye = name.removeprefix(CAMERA)
        pictures = images(client, robot, side, eye, timeout_s=FIRST_PICTURE_S, length=QUEUE)
        return cast("Subscription[object]", pictures)
    row = streams()[name]
    kind, media = header(row), row.publish == "media"
    read: Reader[object] = message(kind, same) if row.payload == kind.__name__ else attached(kind)
    key = row.key.format(robot=robot, side=side)
    timeout_s, bus = (FIRST_PICTURE_S, client.media) if media else (SILENCE_S, None)
    return Subscription(client, key, read, timeout_s=timeout_s, bus=bus)


def attached(kind: type[msgspec.Struct]) -> Reader[object]:
    """Make a reader for the message in the attachment of a publication."""

    def read(client: Client, sample: Sample) -> object:
        received = sample.received
        sent = received.attachment or b""
        return client.read(
            Reply(received.key, sent, codec.MSGPACK, error=False, origin=received.session), kind
        )

    return read
