"""What our sessions and our router tell Zenoh about connections, and why."""

from __future__ import annotations

import json
from collections.abc import Mapping

import zenoh

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import NoAnswer

LEASE_MS = 2000
"""A frozen session, or router, counts as gone after this long; the default of 10 s is too long for a moving robot."""
TCP = {"so_sndbuf": 32768, "so_rcvbuf": 32768}
"""Small socket buffers: what a flooding client has sent waits with the client, not for seconds in the kernel."""
WAIT_DROP_US = 20_000
"""What may be dropped is dropped if it cannot leave for this long; the default of 1 ms loses positions on a busy machine."""
WAIT_CLOSE_US = 500_000
"""A client that reads nothing for this long while replies wait for it is cut off by the router: at the default of 5 s
one flooding client that ends holds up the whole class for seconds."""
RUNTIME = ("ZENOH_RUNTIME", "(rx: (worker_threads: 16))")
"""A router thread that waits for one client that does not read holds up all clients it serves: with Zenoh's three, a
client that floods cut robots off for seconds (measured). Read by Zenoh once, at a process's first session."""
HALF_OPEN = 1000
"""Connections that may be silent at once until they time out; the default of 100 lets one port scanner lock out a class."""


COMMON = {
    "scouting/multicast/enabled": False,
    "transport/shared_memory/enabled": False,
    "transport/link/tcp": TCP,
    "transport/link/tx/lease": LEASE_MS,
    "transport/link/tx/queue/congestion_control/drop/wait_before_drop": WAIT_DROP_US,
}
"""For sessions and router alike."""


def opened(settings: Mapping[str, object], trouble: str) -> zenoh.Session:
    """A session with Zenoh's defaults, but for COMMON and these.

    Raises:
        NoAnswer: NO_ROUTER, with `trouble` and what Zenoh says, without the places in its source.
    """
    config = zenoh.Config()
    for key, value in {**COMMON, **settings}.items():
        config.insert_json5(key, json.dumps(value))
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        said = str(error).partition(" at /")[0]
        raise NoAnswer(Reason.NO_ROUTER, f"{trouble} ({said})") from error
