"""The router of a classroom."""

from __future__ import annotations

import os

import zenoh

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.bus.endpoint import ours
from beatrix_zenoh.bus.transport import HALF_OPEN, LEASE_MS, RUNTIME, WAIT_CLOSE_US, opened
from beatrix_zenoh.errors import WrongUsage


def open_router(listen: str) -> zenoh.Session:
    """Be the router of a classroom: clients meet here. Close the session to end it.

    Raises:
        WrongUsage: BAD_VALUE, if `listen` is no endpoint, or not ours.
        NoAnswer: NO_ROUTER, if the endpoint is taken.
    """
    if not ours(listen):
        raise WrongUsage(
            Reason.BAD_VALUE,
            f"Cannot listen at {listen}: that is another computer. A router listens at 127.0.0.1 (for this computer "
            "only), at 0.0.0.0 or [::] (for all), or at one of this computer's own addresses.",
        )
    os.environ.setdefault(*RUNTIME)
    settings = {
        "mode": "router",
        "listen/endpoints": [listen],
        "listen/exit_on_failure": True,
        "scouting/delay": 0,
        "adminspace/enabled": True,
        "transport/link/tx/queue/congestion_control/block/wait_before_close": WAIT_CLOSE_US,
        "transport/unicast/accept_pending": HALF_OPEN,
        "transport/unicast/accept_timeout": LEASE_MS,
    }
    return opened(
        settings, f"Cannot listen at {listen}: is another router running there? Choose another with --listen."
    )
