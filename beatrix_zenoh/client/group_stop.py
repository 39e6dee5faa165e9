"""STOP and EMERGENCY_STOP to many robots at the same time."""

from __future__ import annotations

from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Command, CommandQuery, CommandReply
from beatrix_zenoh.client.request import GroupRequest
from beatrix_zenoh.client.session import Client

STOP_S = 3.0
"""Time limit (s) of the replies; the slowest stop, from 90 deg/s, takes half a second."""
PRIORITY = "real_time"


def request_stop(
    client: Client, robot: str = "*", twin: str = "*", *, emergency: bool = False
) -> GroupRequest[CommandReply]:
    """Send STOP or EMERGENCY_STOP to all matching robots; read the `replies` of the result within STOP_S."""
    if emergency:
        query = CommandQuery(command=Command.EMERGENCY_STOP.value, source=client.source)
        key = keys.command(robot, twin, client.settings.who)
        return GroupRequest(client, key, query, CommandReply, STOP_S, PRIORITY)
    # A foreign queryable may take the query, so STOP is also published, and before it: the replies then cover both.
    client.put_stop(robot, twin)
    return GroupRequest(client, client.stop_key(robot, twin), None, CommandReply, STOP_S)
