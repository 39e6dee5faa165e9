"""Choose another router or account in the window: what the sheet says, and what real routers answer."""

from __future__ import annotations

import datetime as dt
from dataclasses import replace
from pathlib import Path

import msgspec
import pytest
from class_router import ClassRouter
from gui_links import Linked, look, short
from gui_worlds import absent, account, world
from present import present
from robots import Stage, free_endpoint

from beatrix_zenoh import account as accounts
from beatrix_zenoh.account import Account
from beatrix_zenoh.client import Presence
from gui.console.state.actions import (
    Action,
    LookForPorts,
    MakeReady,
    Outcome,
    Send,
    UseAccount,
    UseRouter,
)
from gui.console.state.connecting import completed
from gui.console.state.intents import Choose, SendHead, TogglePage, WindowPage
from gui.console.state.state import State
from gui.console.state.views import RouterView
from gui.console.state.world import LinkPhase, Trouble, World

ANA, OLD = account("ana"), dt.date(1969, 7, 20)
ALONE = world(absent("sim"), absent("hw"))


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for the settings of the user, who has no account yet."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def sheet(now: World, language: str = "en") -> RouterView:
    """Return what the sheet, open since before the trouble, says about router and account."""
    state = State()
    state.handle(Choose("language", language), now)
    state.handle(LookForPorts(), replace(now, router_trouble=None))
    found = present(state.view(now).connect)
    return found.router


# -- what the sheet says --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("typed", "endpoint"),
    [
        ("192.168.1.20", "tcp/192.168.1.20:7447"),
        (" lab-pc:7448 ", "tcp/lab-pc:7448"),
        ("tcp/127.0.0.1:7447", "tcp/127.0.0.1:7447"),
        ("tls/10.0.0.2:7447,tls/lab:7447", "tls/10.0.0.2:7447,tls/lab:7447"),
        ("[fe80::1]:7447", "tcp/[fe80::1]:7447"),
        ("", ""),
    ],
)
def test_an_address_may_be_typed_without_protocol_and_port(typed: str, endpoint: str) -> None:
    assert completed(typed) == endpoint
    assert State().handle(UseRouter(typed), ALONE) == [UseRouter(endpoint)]


def test_the_sheet_shows_router_and_account_and_takes_one_choice_at_a_time() -> None:
    alone = sheet(ALONE)
    assert (alone.address, alone.good) == (ALONE.endpoint, True)
    assert alone.account.startswith("No account.")
    now = replace(ALONE, account=ANA, choosing=True)
    assert sheet(now).account == "Account ana of class 8b, valid until 2027-07-31."
    assert not sheet(now).use.enabled
    assert State().handle(UseRouter("lab"), now) == []


@pytest.mark.parametrize(
    ("phase", "account", "words"),
    [
        (LinkPhase.NO_ROUTER, None, "Check the address"),
        (LinkPhase.REFUSED, None, "it is no router, or one of a class"),
        (LinkPhase.REFUSED, ANA, "Choose the newest file of your seat"),
        (LinkPhase.REFUSED, account("ana", expires=OLD), "expired on 1969-07-20"),
        (LinkPhase.REFUSED, account("teacher", expires=OLD), "Run beatrix classroom init"),
    ],
)
def test_a_router_that_cannot_be_used_says_what_to_do(
    phase: LinkPhase, account: Account | None, words: str
) -> None:
    now = replace(ALONE, phase=phase, account=account)
    assert words in sheet(now).text
    assert sheet(now).good is False
    assert sheet(now, "de").text != sheet(now).text


def test_undo_and_the_page_of_the_class_belong_to_the_router_that_was_left() -> None:
    teacher = replace(world(), seat="teacher", account=account("teacher"))
    state = State()
    state.follow(teacher)
    state.handle(Choose("hw", value=False), teacher)
    (send,) = state.handle(SendHead(), teacher)
    assert isinstance(send, Send)
    state.report(Outcome(send.row, "sim", accepted=True, done=True))
    assert state.view(teacher).commands.buttons["undo"].enabled
    state.handle(TogglePage(), teacher)
    actions: list[Action] = state.handle(UseAccount(Path("ana.toml")), teacher)
    assert UseAccount(Path("ana.toml")) in actions
    now = replace(teacher, seat="ana", endpoint="tls/lab:7447")
    state.follow(now)
    shown = state.view(now)
    assert shown.choices.page is WindowPage.ROBOT
    assert not shown.commands.buttons["undo"].enabled


# -- real routers ---------------------------------------------------------------------------------


def refused(linked: Linked, action: Action) -> Trouble:
    """Make a choice; return why it is not used."""
    linked.do(action)
    return present(linked.until(lambda world: not world.choosing, "the choice is checked").router_trouble)


def test_another_router_is_used_its_only_robot_is_shown_and_the_motion_of_the_window_ends() -> None:
    with Stage() as here, Stage() as there:
        here.node("bea")
        there.node("anton")
        with Linked(here.endpoint) as linked:
            linked.online("hw")
            assert refused(linked, UseRouter("nonsense")).key == "connect.bad_address"
            assert refused(linked, UseRouter(free_endpoint())).key == "connect.unanswered"
            assert linked.world.phase is LinkPhase.ONLINE, "a wrong address costs no connection"
            assert linked.world.endpoint == here.endpoint
            linked.do(MakeReady("hw", 1))
            assert linked.end_of(1, "hw").accepted
            linked.do(Send(2, look(120.0, 20.0), ("hw",)))
            linked.accepted(2, "hw")
            linked.do(UseRouter(there.endpoint))
            assert not linked.end_of(2, "hw").accepted
            linked.until(lambda world: world.robot == "anton", "the robot of the other router is shown")
            linked.online("hw")
            assert linked.world.endpoint == there.endpoint
            assert linked.world.sim.presence is Presence.ABSENT
            linked.do(UseRouter(here.endpoint))
            linked.until(lambda world: world.robot == "bea", "the first robot is shown again")
            assert short(linked.online("hw"), "hw") < 110.0


def test_account_files_are_checked_before_they_are_stored(folder: Path) -> None:
    (folder / "one").mkdir()
    with ClassRouter(folder / "one") as router, Stage() as stage:
        old, junk = folder / "old.toml", folder / "junk.toml"
        ana = router.account("ana")
        old.write_text(msgspec.structs.replace(ana, expires=dt.date(2020, 7, 31)).text())
        junk.write_text("speed = 3\n")
        with Linked(stage.endpoint) as linked:
            linked.until(lambda world: world.phase is LinkPhase.ONLINE, "a session without an account")
            assert refused(linked, UseAccount(folder / "none.toml")).key == "connect.no_file"
            assert refused(linked, UseAccount(junk)).key == "connect.not_account"
            expired = refused(linked, UseAccount(old))
            assert (expired.key, expired.slots["expires"]) == ("connect.expired", "2020-07-31")
            assert refused(linked, UseRouter(ana.connect)).key == "connect.needs_account"
            former = folder / "former.toml"
            former.write_text(router.replace("ana").text())
            router.process.expect("ready")  # until it has restarted, it accepts the former account
            assert refused(linked, UseAccount(former)).key == "connect.foreign"
            assert linked.world.endpoint == stage.endpoint
            assert not accounts.joined().exists(), "nothing was stored"
            linked.do(UseAccount(router.path("ana")))
            joined = linked.until(lambda world: world.account is not None, "the account is used")
            assert (joined.seat, joined.robot, joined.endpoint) == ("ana", "ana", ana.connect)
            linked.until(lambda world: world.phase is LinkPhase.ONLINE, "the router of the class accepts it")
            assert accounts.load(accounts.joined()).name == "ana"
            linked.do(UseRouter(stage.endpoint))
            left = linked.until(lambda world: world.account is None, "no account at another router")
            assert left.endpoint == stage.endpoint
            linked.do(UseRouter(ana.connect))
            linked.until(
                lambda world: world.account is not None, "the account of this computer is used again"
            )
