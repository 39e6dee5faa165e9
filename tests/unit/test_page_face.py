"""The control page without a network: hosts, PINs, messages, who drives, texts and contrasts."""

from __future__ import annotations

import re
import time
from dataclasses import replace
from pathlib import Path
from typing import get_args
from unittest.mock import MagicMock

import msgspec
import pytest
from contrast import contrast
from gui_worlds import absent, robot, status, world

from beatrix_zenoh.contract._generated.messages import LeaseAction, Status
from beatrix_zenoh.contract.errors import WrongUsage
from gui.console.state import actions
from gui.console.state.actions import AskLease
from gui.console.state.gestures import RunExample
from gui.console.state.intents import Intent
from gui.console.state.missions import STEPS, TASKS, CloseGuide, ResumeGuide, SkipTask
from gui.console.state.world import World
from gui.page import messages, protection, server
from gui.page.face import Driver, Face
from gui.page.hub import PROGRAMS_MAX, Hub
from gui.page.lessons_face import Lessons
from gui.page.protection import PinLogin
from gui.page.shelf import Desk, Shelf
from gui.page.sockets import MALFORMED
from gui.page.static_files import STATIC

DESK = Desk(Shelf(Path("nowhere")), "guest-1")
LESSONS = Lessons(Path("nowhere"), lambda *_: None)


@pytest.mark.parametrize(
    ("host", "address", "allowed"),
    [
        ("127.0.0.1:8088", "127.0.0.1", True),
        ("localhost:8088", "127.0.0.1", True),
        ("192.168.1.20:8088", "192.168.1.20", True),
        ("localhost:8088", "192.168.1.20", False),
        ("127.0.0.1:8088", "192.168.1.20", False),
        ("127.0.0.1", "127.0.0.1", False),
        ("192.168.1.20.evil.example:8088", "192.168.1.20", False),
        ("", "127.0.0.1", False),
    ],
)
def test_only_the_address_of_the_connection_is_allowed_as_host(
    host: str, address: str, allowed: bool
) -> None:
    assert protection.host_allowed(host, address, 8088) is allowed


def test_connections_are_limited_in_total_and_for_each_address() -> None:
    assert not server.too_many(["a"] * server.ADDRESS_MAX, "b")
    assert server.too_many(["a"] * server.ADDRESS_MAX, "a")
    assert server.too_many([str(number) for number in range(server.CONNECTIONS_MAX)], "new")


def test_one_address_gets_five_tries_a_minute() -> None:
    login = PinLogin("123456", None)
    for moment in range(5):
        assert login.enter("654321", "a", float(moment)).refusal == "page.wrong_pin"
    assert login.enter("123456", "a", 4.0) == ("", "page.wait", 56.0)
    assert login.enter("123456", "b", 4.0).ticket
    assert login.enter(" 123456 ", "a", 60.0).ticket


@pytest.mark.parametrize("pin", ["", "12345", "x" * 65])
def test_a_chosen_pin_of_another_length_than_6_to_64_is_refused(
    pin: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(protection.PIN_VARIABLE, pin)
    with pytest.raises(WrongUsage, match="choose 6 to 64") as refused:
        protection.chosen_pin()
    assert not pin or pin not in refused.value.message


def test_a_page_cannot_name_files_or_start_programs() -> None:
    allowed = get_args(messages.OWN) + get_args(messages.DRIVING)
    for intent in allowed:
        assert not {"Path", "Place"} & {str(field.type) for field in msgspec.structs.fields(intent)}
    local = {action for action in vars(actions).values() if isinstance(action, type)} & {*allowed}
    known = {actions.ChooseRobot, actions.MakeReady, actions.AskLease, actions.SendNow, actions.Abort}
    # Play: of a gesture only, see the forged messages below; Govern: only the teacher's page has a class to govern.
    assert local == {*known, actions.EndBlocks, actions.EndProgram, actions.Play, actions.Govern}


# -- what a page may send, and what it does while it drives -----------------------------------------


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
        '{"do":"Play","row":1,"sides":["sim"],"file":"/etc/passwd"}',
        '{"do":"Play","row":0,"sides":[],"gesture":"../demo"}',
        '{"do":"Play","row":0,"sides":["hw"],"gesture":"yes"}',
        '{"do":"RunExample","program":"../own.py"}',
        '{"do":"RunExample","program":"follow","file":"own.py"}',
        '{"do":"RunProgram","row":-1,"file":"own.py"}',
        '{"do":"SaveGesture","name":"wink","emoji":"x\\n0,0,0,0,30"}',
        '{"do":"KeepGesture","row":-1,"name":"wink","text":""}',
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
        '{"do":"Play","row":0,"sides":[],"poses":[],"again":[],"lead_s":0.0,"gesture":"yes"}',
        '{"do":"RunExample","program":"turn"}',
        '{"do":"SaveGesture","name":"wink","emoji":"😎"}',
    ],
)
def test_a_message_of_a_button_or_a_field_is_read(sent: str) -> None:
    assert type(messages.read(sent)).__name__ == msgspec.json.decode(sent)["do"]


def driving(now: World) -> tuple[Face, MagicMock]:
    """Return the face of a page that drives, and its link."""
    face, link = (
        Face(now, "guest-1", lambda _: None, lambda: None, lambda *_: True, DESK, LESSONS),
        MagicMock(),
    )
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


def test_a_page_that_drives_shows_missions_and_then_the_way_to_the_lessons() -> None:
    now, shown = world(robot("sim"), absent("hw")), []
    face, link = driving(now)
    face._send = lambda sent: shown.append(msgspec.json.decode(sent).get("guide"))
    face.carry_out(actions.MakeReady("sim"))
    row = link.do.call_args.args[0].row
    face.report(actions.Outcome(row, "sim", accepted=True, done=True))
    for task in range(1, len(TASKS) + 1):  # the robot is ready
        now = replace(now, now_s=now.now_s + 1.0)
        face.show(now, (now.robot,))
        assert (shown[-1]["skip"] is None) is (task == len(TASKS))
        assert (shown[-1]["hint"] is not None) is (len(STEPS) <= task < len(TASKS))
        face.carry_out(SkipTask())
    assert shown[0]["text"] == "✓ Well done."
    assert "lessons" in shown[-1]["text"]
    nods = [call.args[0] for call in link.do.call_args_list if isinstance(call.args[0], actions.Play)]
    assert [nod.gesture for nod in nods] == ["yes"]
    for closes, shows in ((CloseGuide(), "resume"), (ResumeGuide(), "text")):
        face.carry_out(closes)
        face.show(now, (now.robot,))
        assert shows in shown[-1]
    face.driver = None
    face.show(now, (now.robot,))
    assert shown[-1] is None, "a page that only watches has none"


@pytest.mark.parametrize(("others", "runs"), [(PROGRAMS_MAX - 1, True), (PROGRAMS_MAX, False)])
def test_programs_run_for_a_few_pages_at_once(
    others: int, runs: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    face, _ = driving(world(robot("sim"), absent("hw")))
    carried: list[Intent] = []
    monkeypatch.setattr(face, "carry_out", carried.append)
    pages = {face, *(MagicMock(runs_program=True) for _ in range(others)), MagicMock(runs_program=False)}
    Hub.run_example(MagicMock(pages=pages), face, RunExample("follow"))
    assert carried == [RunExample("follow")] * runs
    assert bool(face._notice[0]) is not runs


# -- the page ------------------------------------------------------------------------------------------

SCRIPTS = "".join(path.read_text() for path in STATIC.glob("*.js"))
STYLE = (STATIC / "page.css").read_text()
COLOURS = dict(re.findall(r"--([a-z-]+): (#[0-9a-f]{6});", STYLE))


def test_page_and_server_use_the_same_code_for_a_closed_web_socket() -> None:
    assert f"const MALFORMED = {MALFORMED};" in SCRIPTS


@pytest.mark.parametrize(
    ("text", "ground"),
    [
        *[(text, ground) for text in ("text", "dim") for ground in ("ground", "panel", "field", "raised")],
        *[(text, "panel") for text in ("good", "warn", "bad")],
        ("text", "notice"),
        ("accent-text", "accent"),
        ("held-text", "held"),
        ("stop-text", "stop"),
        ("stop-text", "stop-pressed"),
        ("accent-text", "warn"),
    ],
)
def test_texts_contrast_with_their_background(text: str, ground: str) -> None:
    assert contrast(COLOURS[text], COLOURS[ground]) >= 4.5
