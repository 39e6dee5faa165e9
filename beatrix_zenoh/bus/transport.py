"""Zenoh settings of our sessions and our router, each with its reason."""

from __future__ import annotations

import json
from collections.abc import Mapping

import zenoh

from beatrix_zenoh import memory
from beatrix_zenoh.bus import forks
from beatrix_zenoh.bus.at_exit import OPEN
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer

LEASE_MS = 2000
"""Time after which an unresponsive session or router counts as lost; the default, 10 s, is too long for moving arms."""
TCP = {"so_sndbuf": 32768, "so_rcvbuf": 32768}
"""Small socket buffers: data of a flooding client waits in that client, not for seconds in the kernel."""
WAIT_DROP_US = 20_000
"""Time after which a droppable message that cannot be sent is dropped; at the default of 1 ms a busy machine loses
positions."""
WAIT_CLOSE_US = 500_000
"""Time after which the router disconnects a client that does not read its replies; at the default of 5 s, one
flooding client that ends would delay the whole class for seconds."""
RUNTIME = ("ZENOH_RUNTIME", "(rx: (worker_threads: 16), acc: (worker_threads: 16))")
"""Environment variable with the numbers of the router's threads. A receiving thread (rx) that waits for a client that
does not read delays all clients of the same thread: with the default of three threads, one client disconnected robots
for seconds (measured). With the default of one accepting thread (acc), STOP waited up to 0.6 s while 150 half-open
connections timed out; with 16 threads it waited 0.03 s (measured). Zenoh reads the variable once, at the first
session."""
LARGEST_MESSAGE = 1024 * 1024
"""Largest message (bytes) that sessions and router assemble from fragments, and that a router of a class passes on; the
default of 1 GiB lets one client fill the memory of the receiver. The largest of ours are pictures and lists of events."""
MESSAGE_HEADER = 4 * 1024
"""Room for the key, attachment and header of a message (bytes)."""
OPEN_MS = 2000
"""Time after which a router that accepts a connection and does not answer counts as lost; the default is 10 s."""
RETRY = {"period_init_ms": 50, "period_max_ms": 500, "period_increase_factor": 2}
"""Times between two attempts to connect."""
HALF_OPEN = 1000
"""Largest number of connections that have not sent anything yet; at the default of 100 a port scan locks out a
class."""


COMMON = {
    "scouting/multicast/enabled": False,
    "transport/shared_memory/enabled": False,
    "transport/link/tcp": TCP,
    "transport/link/tx/lease": LEASE_MS,
    "transport/link/rx/max_message_size": LARGEST_MESSAGE + MESSAGE_HEADER,
    "transport/unicast/open_timeout": OPEN_MS,
    "transport/link/tx/queue/congestion_control/drop/wait_before_drop": WAIT_DROP_US,
}
"""Settings of sessions and router."""


def opened(settings: Mapping[str, object], trouble: str, reason: Reason = Reason.NO_ROUTER) -> zenoh.Session:
    """Open a session with Zenoh's defaults, except COMMON and `settings`.

    Raises:
        WrongUsage: BAD_VALUE, this process was forked from one that has opened a session.
        NoAnswer: Zenoh cannot open the session. The error has `reason`; its message is `trouble`, followed
            by Zenoh's own text without source locations.
    """
    memory.share_pools()
    config = zenoh.Config()
    for key, value in {**COMMON, **settings}.items():
        config.insert_json5(key, json.dumps(value))
    forks.opening()
    try:
        with OPEN.call():
            return zenoh.open(config)
    except zenoh.ZError as error:
        raise NoAnswer(reason, f"{trouble} ({_cause(error)})") from error


def closed(session: zenoh.Session) -> str:
    """Close a session; return "" or, if the other side did not let it close in time, Zenoh's text."""
    try:
        session.close()
    except zenoh.ZError as error:
        return _cause(error)
    return ""


def _cause(error: zenoh.ZError) -> str:
    """Return Zenoh's text without source locations."""
    return str(error).partition(" at /")[0]
