"""Lease queries to many robots at the same time, so that a robot that does not answer does not delay the others."""

from __future__ import annotations

import time
from collections.abc import Iterable

from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import LeaseAction, LeaseQuery, LeaseReply, Reason
from beatrix_zenoh.client.request import Place, Request
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.errors import BeatrixError, NoAnswer, Refused

ANSWER_S = 2.0
"""Time limit (s) of all replies together."""
NO_REPLY = (
    f"The robot did not answer within {ANSWER_S:g} s, so its state is not known: its node hangs or is not connected. "
    "Send the request again when the robot answers."
)


def govern(
    client: Client, places: Iterable[Place], action: LeaseAction, speed: float = 0.0
) -> dict[Place, LeaseReply | BeatrixError]:
    """Send a lease query to all these robots, and return the reply or error of each; `speed` (rad/s) is for LIMIT."""
    query = LeaseQuery(action=action, speed=speed)
    who = client.settings.who
    requests = {place: Request(client, place, keys.lease(*place, who), query, ANSWER_S) for place in places}
    deadline_s = time.monotonic() + ANSWER_S
    return {place: _result(request, deadline_s) for place, request in requests.items()}


def _result(request: Request, deadline_s: float) -> LeaseReply | BeatrixError:
    """Return the reply that arrives before `deadline_s` (monotonic clock, s), or the error."""
    try:
        reply = request.reply(LeaseReply, max(0.0, deadline_s - time.monotonic()))
    except TimeoutError:
        return NoAnswer(Reason.TIMED_OUT, NO_REPLY)
    except BeatrixError as error:
        return error
    finally:
        request.close()
    return reply if reply.result else Refused(reply.reason, reply.message, reply.detail)
