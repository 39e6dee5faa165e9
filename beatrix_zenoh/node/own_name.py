"""Claim of a robot's name: if several nodes start at the same time under one name, at most one of them serves."""

from __future__ import annotations

import time

from beatrix_zenoh.bus import Bus
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused

WAIT_S = 3.0
"""Longest time (s) to wait until another claimant withdraws or serves; a node starts in less than two seconds."""
POLL_S = 0.02


def claim_name(bus: Bus, name: str, twin: str) -> None:
    """Claim the name until the session ends, because two robots with one name would both carry out every request.

    Each node first declares its claim, then looks for other claims, so of two nodes at least one sees the other. The
    node with the larger session id withdraws its claim; the other node waits for this. If a node that looked earlier
    begins to serve, or after WAIT_S, the waiting node withdraws too.

    Raises:
        Refused: NAME_TAKEN; the claim was withdrawn.
        NoAnswer: ACCOUNT_REFUSED, the router has no rules for the account of this session.
    """
    alive, own = keys.alive(name, twin), keys.claim(name, twin, bus.session_id)
    if bus.tokens(alive):
        raise taken(bus, name, twin)
    withdraw = bus.declare_token(own)
    if (refused := bus.refusal(own)) is not None:
        raise refused
    deadline = time.monotonic() + WAIT_S
    while others := [other for other in bus.tokens(keys.claim(name, twin, "*")) if other != own]:
        if min(others) < own or bus.tokens(alive) or time.monotonic() > deadline:
            withdraw()
            raise taken(bus, name, twin)
        time.sleep(POLL_S)


def taken(bus: Bus, name: str, twin: str) -> Refused:
    """Return the refusal of a second node with the same name."""
    return Refused(
        Reason.NAME_TAKEN,
        f"A {twin} robot named {name!r} is already on line at {bus.endpoint}. Start this robot under another "
        "name (--name), or end the other robot; `beatrix ls` lists the robots.",
    )
