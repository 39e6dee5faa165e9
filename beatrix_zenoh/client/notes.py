"""Notes for the recordings that run at a router."""

from __future__ import annotations

import contextlib
import time
from typing import Final

from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import NoteQuery, NoteReply, Reason
from beatrix_zenoh.contract.errors import NoAnswer

ANSWER_S: Final = 2.0
NONE: Final = (
    "No recording is running at this router, so the note is written nowhere. Start one with `beatrix record FILE.rrd`; "
    "`beatrix record FILE.rrd --note TEXT` begins with a note."
)


def send_note(client: Client, text: str) -> list[NoteReply]:
    """Put a note into every running recording under the seat of the client; return the reply of each.

    Raises:
        NoAnswer: NO_ANSWER, no recording is running; ACCOUNT_REFUSED, the router drops the messages of this account.
        WrongUsage: SHUTDOWN, the client was closed.
    """
    key = keys.note(client.settings.who, "*")
    query = client.bus.query(key, codec.encode(NoteQuery(text=text)), codec.MSGPACK, timeout_s=ANSWER_S)
    found, deadline_s = [], time.monotonic() + ANSWER_S
    try:
        with contextlib.suppress(TimeoutError):
            while (reply := query.next(deadline_s - time.monotonic())) is not None:
                if not reply.error and (answer := client.read(reply, NoteReply)) is not None:
                    found.append(answer)
    finally:
        query.close()
    if not found:
        raise client.bus.refusal(client.token) or NoAnswer(Reason.NO_ANSWER, NONE)
    return found
