"""Lease queries to many robots at the same time, so that a robot that does not answer does not delay the others."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed

from beatrix_zenoh.client.request import Place, Request
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LeaseQuery, LeaseReply, Reason
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer, Refused

ANSWER_S = 2.0
"""Time limit (s) of the reply of each robot."""
AT_ONCE = 128
"""Largest number of robots that are waited for at the same time; a class has at most two for each account."""
NO_REPLY = (
    f"The robot did not answer within {ANSWER_S:g} s, so its state is not known: its node hangs or is not connected. "
    "Send the request again when the robot answers."
)


def govern(
    client: Client, places: Sequence[Place], query: LeaseQuery
) -> Iterator[tuple[Place, LeaseReply | BeatrixError]]:
    """Send a lease query to all these robots at once, and yield the reply or error of each as it arrives.

    The robots of the class are the first, before those of connected seats.
    """
    seats = {parts.who for parts in map(keys.parse, client.bus.tokens(keys.seat("*", "*"))) if parts}
    ordered = sorted(places, key=lambda place: (place[0] in seats, place[1] != "hw", place))
    with ThreadPoolExecutor(AT_ONCE, "beatrix-govern") as threads:
        asked = {threads.submit(_ask, client, place, query): place for place in ordered}
        for answered in as_completed(asked):
            yield asked[answered], answered.result()


def _ask(client: Client, place: Place, query: LeaseQuery) -> LeaseReply | BeatrixError:
    """Return the reply of a robot that arrives within ANSWER_S, or the error."""
    request = Request(client, place, keys.lease(*place, client.settings.who), query, ANSWER_S)
    try:
        reply = request.reply(LeaseReply, ANSWER_S)
    except TimeoutError:
        return NoAnswer(Reason.TIMED_OUT, NO_REPLY)
    except BeatrixError as error:
        return error
    finally:
        request.close()
    return reply if reply.result else Refused(reply.reason, reply.message, reply.detail)
