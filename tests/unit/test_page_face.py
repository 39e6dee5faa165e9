"""What a page may send, and what it does while it drives, without a network and without robots."""

from __future__ import annotations

import time
from unittest.mock import MagicMock

import msgspec
import pytest
from gui_worlds import absent, robot, status, world

from beatrix_zenoh.contract._generated.messages import LeaseAction, Status
from gui.console.state.actions import AskLease
from gui.console.state.world import World
from gui.page import messages
from gui.page.face import Driver, Face


@pytest.mark.parametrize(
    "forged",
    [
        '{"do":"AskLease","action":"freeze","side":"hw"}',
        '{"do":"AskLease","action":"take","side":"zz"}',
        '{"do":"MakeReady","side":"*"}',
        '{"do":"Choose","name":"xx","value":true}',
        '{"do":"RunCommand","command":4}',
        '{"do":"AimHead","yaw":1e9,"pitch":0,"roll":0}',
        '{"do":"AddPose","name":"' + "x" * 65 + '"}',
        '{"do":"Govern","row":1,"action":"freeze"}',
        '{"do":"Play","row":1,"sides":["sim"],"file":"/etc/passwd"}',
    ],
)
def test_a_message_that_no_page_sends_is_invalid(forged: str) -> None:
    with pytest.raises(msgspec.DecodeError):
        messages.read(forged)


@pytest.mark.parametrize(
    "sent",
    [
        '{"do":"AskLease","action":"wait","side":"hw"}',
        '{"do":"MakeReady","side":"sim"}',
        '{"do":"RunCommand","command":6,"side":"hw"}',
        '{"do":"AimHead","yaw":180,"pitch":-30,"roll":0}',
        '{"do":"AddPose","name":"Kopf hoch"}',
    ],
)
def test_a_message_of_a_button_or_a_field_is_read(sent: str) -> None:
    assert type(messages.read(sent)).__name__ == msgspec.json.decode(sent)["do"]


def driving(now: World) -> tuple[Face, MagicMock]:
    """Return the face of a page that drives, and its link."""
    face, link = Face(now, "guest-1", lambda _: None, lambda: None, lambda *_: None), MagicMock()
    face.driver = Driver(link, "web-mia", time.monotonic())
    return face, link


def asked(link: MagicMock) -> list[tuple[LeaseAction, str]]:
    """Return the leases that a page has asked for since the last call."""
    given = [call.args[0] for call in link.do.call_args_list]
    link.do.reset_mock()
    return [(action.action, action.side) for action in given if isinstance(action, AskLease)]


def test_a_page_that_drives_asks_for_each_side_that_comes_online() -> None:
    sim, both = world(robot("sim"), absent("hw")), world(robot("sim"), robot("hw"))
    face, link = driving(sim)
    wanted = []
    for now in (sim, sim, both, both, world(absent("sim"), robot("hw")), both):
        face.show(now, (now.robot,))
        wanted.append(asked(link))
    ask_sim, ask_hw = (LeaseAction.WAIT, "sim"), (LeaseAction.WAIT, "hw")
    assert wanted == [[ask_sim], [], [ask_hw], [], [], [ask_sim]]


@pytest.mark.parametrize(
    ("known", "text"),
    [
        (status("sim", holder="web-ana", lease=7, waiting=("web-mia",)), "You wait as web-mia."),
        (status("sim", holder="web-mia", lease=7), "You drive as web-mia."),
    ],
)
def test_a_page_in_the_queue_does_not_say_that_it_drives(known: Status, text: str) -> None:
    now = world(robot("sim", known=known), absent("hw"))
    sent: list[bytes] = []
    face, _ = driving(now)
    face._send = sent.append
    face.show(now, (now.robot,))
    assert msgspec.json.decode(sent[0])["you"]["text"] == text
