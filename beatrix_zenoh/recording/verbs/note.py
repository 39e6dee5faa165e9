"""`beatrix note`: put a note into every running recording."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated, Final

import msgspec
import typer

from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import NoteQuery, NoteReply, Reason
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.output import exit_code, print_json, say
from beatrix_zenoh.settings import resolve
from beatrix_zenoh.terminal.options import Connect, Json, Who

ANSWER_S: Final = 2.0
NONE: Final = (
    "No recording is running at this router, so the note is written nowhere. Start one with `beatrix record FILE.rrd`; "
    "`beatrix record FILE.rrd --note TEXT` begins with a note."
)


def note(
    text: Annotated[list[str], typer.Argument(metavar="TEXT", help="The note, for example: trial 3 begins")],
    connect: Connect = None,
    who: Who = None,
    as_json: Json = False,
) -> None:
    """Put a note into every running recording.

    It appears in the log and on the time line of the viewer, with your seat. `beatrix record` makes recordings.
    """
    with Client(resolve(None, connect, who)) as client:
        replies = send_note(client, " ".join(text))
    good = all(reply.result for reply in replies)
    if as_json:
        print_json({"result": good, "recordings": msgspec.to_builtins(replies)})
    else:
        for reply in replies:
            say(line(reply))
    if not good:
        raise typer.Exit(exit_code(next(reply.reason for reply in replies if not reply.result)))


def line(reply: NoteReply) -> str:
    """Return the outcome for one recording as a sentence."""
    name = f"{reply.file} ({reply.title})" if reply.title else reply.file
    if not reply.result:
        return f"{name}: not noted: {reply.message}"
    moment = datetime.fromtimestamp(reply.t_wall_ns / 1e9, UTC)
    return f"{name}: noted at {moment:%H:%M:%S} UTC."


def send_note(client: Client, text: str) -> list[NoteReply]:
    """Put a note into every running recording under the seat of the client; return the reply of each.

    Raises:
        NoAnswer: NO_ANSWER, no recording is running; ACCOUNT_REFUSED, the router has put this account out.
        WrongUsage: SHUTDOWN, the client was closed.
    """
    key = keys.note(client.settings.who, "*")
    query = client.bus.query(
        key, codec.encode_request(NoteQuery(text=text)), codec.MSGPACK, timeout_s=ANSWER_S
    )
    answers = (client.read(reply, NoteReply) for reply in query.replies(ANSWER_S) if not reply.error)
    found = [answer for answer in answers if answer is not None]
    if not found:
        raise client.bus.refusal() or NoAnswer(Reason.NO_ANSWER, NONE)
    return found
