"""The loss of the router: all tokens disappear; test_access_sequences.py has which leases and places remain."""

from __future__ import annotations

import pytest
from access_callers import ANA, BEN, CLEO, begin_motion, refusal

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.node.access import Access, Operation
from beatrix_zenoh.node.known_sessions import RETURN_S, SETTLE_S
from beatrix_zenoh.node.lease_queries import standing, take
from beatrix_zenoh.node.leases import IDLE_S

LOST_S, BACK_S = 10.0, 20.0
NOTICED_S = 0.001
"""Time from the disappearance of the tokens to the notice of the lost router."""
GIVEN_UP_S = BACK_S + RETURN_S
BEFORE = ("ana", 1, ["ben", "cleo"])


@pytest.fixture
def access() -> Access:
    """A robot without a router: ana has taken it, ben and cleo wait."""
    access = Access()
    take(access, ANA, 0)
    take(access, BEN, 0, wait=True)
    take(access, CLEO, 0, wait=True)
    for caller in (ANA, BEN, CLEO):
        access.session_changed(caller, LOST_S, alive=False)
    access.router_changed(LOST_S + NOTICED_S, connected=False)
    return access


def return_of(access: Access, *sessions: object) -> Access:
    """Connect the router, and then these sessions."""
    access.router_changed(BACK_S, connected=True)
    for caller in (ANA, BEN, CLEO):
        if caller in sessions:
            access.session_changed(caller, BACK_S + 0.8, alive=True)
    return access


def test_while_the_router_is_lost_no_session_ends(access: Access) -> None:
    assert not access.give_up_sessions(1000)
    assert standing(access, 1000)[:3] == BEFORE
    assert refusal(access, ANA, 1000) is Reason.CLIENT_LOST, "a late request of before the loss"


def test_a_request_before_the_token_is_accepted_and_its_motion_ends_with_the_session(access: Access) -> None:
    begin_motion(return_of(access), ANA, BACK_S + 0.5)
    assert access.give_up_sessions(GIVEN_UP_S), "the client of the running motion is lost"
    assert refusal(access, ANA, GIVEN_UP_S, Operation.ENABLE) is Reason.CLIENT_LOST


def test_a_second_loss_restarts_the_time(access: Access) -> None:
    return_of(access)
    access.router_changed(BACK_S + 1, connected=False)
    access.give_up_sessions(GIVEN_UP_S)
    access.router_changed(BACK_S + 5, connected=True)
    access.give_up_sessions(BACK_S + 5)
    assert standing(access, BACK_S + 5)[:3] == BEFORE
    access.give_up_sessions(BACK_S + 5 + RETURN_S)
    assert standing(access, BACK_S + 5 + RETURN_S)[:3] == ("", 0, [])


def test_the_holder_is_not_idle_while_it_cannot_send_requests(access: Access) -> None:
    access.router_changed(2 * IDLE_S, connected=True)
    for caller in (ANA, BEN, CLEO):
        access.session_changed(caller, 2 * IDLE_S, alive=True)
    assert standing(access, 3 * IDLE_S - 1)[:3] == BEFORE
    assert standing(access, 3 * IDLE_S).holder == "ben"


def test_a_seat_that_is_disconnected_after_the_return_loses_its_lease_as_usual(access: Access) -> None:
    return_of(access, ANA, BEN, CLEO).session_changed(ANA, BACK_S + 1, alive=False)
    access.give_up_sessions(BACK_S + 1 + SETTLE_S)
    assert standing(access, BACK_S + 1 + SETTLE_S)[:3] == ("ben", 2, ["cleo"])
