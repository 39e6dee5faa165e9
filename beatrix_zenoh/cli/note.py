"""`beatrix note`: put a note into every running recording."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated

import typer

from beatrix_zenoh.cli.options import Connect, Json, Who
from beatrix_zenoh.cli.output import exit_code, print_json, say
from beatrix_zenoh.client.notes import send_note
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract._generated.messages import NoteReply
from beatrix_zenoh.settings import resolve


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
        print_json({"result": good, "recordings": [as_row(reply) for reply in replies]})
    else:
        for reply in replies:
            say(line(reply))
    if not good:
        raise typer.Exit(exit_code(next(reply.reason for reply in replies if not reply.result)))


def as_row(reply: NoteReply) -> dict[str, object]:
    """Return the outcome for one recording, for JSON output."""
    return {
        "result": reply.result,
        "reason": reply.reason,
        "message": reply.message,
        "file": reply.file,
        "title": reply.title,
        "t_wall_ns": reply.t_wall_ns,
    }


def line(reply: NoteReply) -> str:
    """Return the outcome for one recording as a sentence."""
    name = f"{reply.file} ({reply.title})" if reply.title else reply.file
    if not reply.result:
        return f"{name}: not noted: {reply.message}"
    moment = datetime.fromtimestamp(reply.t_wall_ns / 1e9, UTC)
    return f"{name}: noted at {moment:%H:%M:%S} UTC."
