"""One robot, one name: of several nodes that start at once under a name, one serves."""

from __future__ import annotations

import time

from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.bus import Bus
from beatrix_zenoh.errors import Refused

WAIT_S = 3.0
"""For another claimant to withdraw or to serve; a node needs less than two seconds to start."""
TURN_S = 0.02


def claim(bus: Bus, name: str, twin: str) -> None:
    """Take the name for as long as the session lives; two robots under one name would both obey.

    Claim first, look afterwards: of two claimants at least one sees the other. The larger session id
    withdraws; the smaller waits for that, because the larger may have looked before.

    Raises:
        Refused: NAME_TAKEN; nothing stays claimed.
    """
    alive, own = keys.alive(name, twin), keys.claim(name, twin, bus.session_id)
    if bus.present(alive):
        raise taken(bus, name, twin)
    bus.announce(own)
    deadline = time.monotonic() + WAIT_S
    while others := [other for other in bus.present(keys.claim(name, twin, "*")) if other != own]:
        if min(others) < own or bus.present(alive) or time.monotonic() > deadline:
            bus.withdraw(own)
            raise taken(bus, name, twin)
        time.sleep(TURN_S)


def taken(bus: Bus, name: str, twin: str) -> Refused:
    """What to tell who comes second."""
    return Refused(
        Reason.NAME_TAKEN,
        f"A {twin} robot named {name!r} is on line at {bus.endpoint} already. Give this one another name "
        f"(--name), or end the other; `beatrix ls` shows who is there.",
    )
