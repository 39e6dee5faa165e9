"""What our sessions and our router tell Zenoh about connections, and why."""

from __future__ import annotations

import json
from collections.abc import Mapping

import zenoh

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


def configured(settings: Mapping[str, object]) -> zenoh.Config:
    """Zenoh's defaults, but for these."""
    config = zenoh.Config()
    for key, value in settings.items():
        config.insert_json5(key, json.dumps(value))
    return config


def short(error: zenoh.ZError) -> str:
    """What Zenoh says, without the places in its source."""
    return str(error).partition(" at /")[0]
