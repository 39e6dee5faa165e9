"""The history: requests of the window and of other seats, and the program so far."""

from __future__ import annotations

from dataclasses import replace
from itertools import count
from typing import Any
from unittest.mock import MagicMock, create_autospec

import pytest
from golden import same
from gui_worlds import robot, state_after, status, world

import beatrix_zenoh
from beatrix_zenoh.client import Plan, Robot, Twin
from beatrix_zenoh.contract._generated.messages import Command, Event, EventKind, LeaseAction, Phase, Reason
from beatrix_zenoh.contract.refusals import not_enabled
from gui.console.state import intents
from gui.console.state.actions import AskLease, MakeReady, Outcome, Play, Send, SendCommand
from gui.console.state.intents import Choose, Intent, Jog, RunCommand
from gui.console.state.state import State
from gui.console.state.views import HistoryRowView
from gui.console.state.world import World

BOTH = Choose("hw", value=True)
HW_ONLY = (BOTH, Choose("sim", value=False))
LOOK = (intents.AimHead(20, -10, 0), intents.SendHead())
SEQ = count(1)


def newest(*given: Intent, now: World | None = None) -> HistoryRowView:
    return state_after(*given, now=now).view(now or world()).history[0]


# -- own rows ----------------------------------------------------------------------------------------


def test_a_row_follows_its_motion_to_its_end() -> None:
    state, now = State(), world()
    for intent in (BOTH, *LOOK):
        state.handle(intent, now)
    row = state.view(now).history[0]
    assert (row.who, row.what, row.result, row.good) == ("you", "look left 20, up 10", "sent", None)
    state.report(Outcome(1, "", accepted=True, done=False, duration_s=1.2))
    row = state.view(now).history[0]
    assert (row.result, row.good) == ("under way, takes 1.2 s", None)
    state.report(Outcome(1, "", accepted=True, done=True, duration_s=1.21))
    view = state.view(now)
    assert (view.history[0].result, view.history[0].good) == ("done, 1.2 s", True)
    same("state history.a row follows its motion to its end", view.last)


def test_a_motion_is_sent_again_to_the_robots_that_are_checked_now() -> None:
    state = State()
    (first,) = state.handle(Jog("short", 1), world())
    state.handle(BOTH, world())
    (again,) = state.handle(intents.Repeat(1), world())
    assert isinstance(first, Send)
    assert isinstance(again, Send)
    assert (again.row, again.query, again.sides, again.lead_s) == (2, first.query, ("sim", "hw"), 2.0)
    state.handle(RunCommand(Command.RESET, side="sim"), world())
    (reset,) = state.handle(intents.Repeat(3), world())
    assert reset == SendCommand(4, Command.RESET, value=True, sides=("sim",))
    assert state.handle(intents.Repeat(77), world()) == []
    assert state.view(world()).commands.refusal is not None


@pytest.mark.parametrize("reason", [Reason.NODE_LOST, Reason.TIMED_OUT, Reason.MUTED])
@pytest.mark.parametrize("intent", [intents.Stop(), intents.EmergencyStop()])
def test_a_stop_that_one_side_has_not_carried_out_is_not_called_refused(
    intent: Intent, reason: Reason
) -> None:
    state = State()
    state.handle(intent, world())
    state.report(Outcome(1, "sim", accepted=True, done=True))
    state.report(Outcome(1, "hw", accepted=False, done=True, reason=reason, message="It is off."))
    row = state.view(world()).history[0]
    assert (row.result, row.good) == ("not confirmed by Hardware: It is off.", False)


# -- lines -------------------------------------------------------------------------------------------

OFF = RunCommand(Command.ENABLE, value=False)
OWN = Play(0, (), gesture="it is")
POSES = (intents.AddPose("a"), intents.AddPose("b"), intents.PlaySequence("sim"))
LOOKING = "yaw=20, pitch=-10, roll=0, speed=30"
LINES: list[tuple[tuple[Intent, ...], str]] = [
    ((BOTH, *LOOK), f"twin.preview({LOOKING}).commit(lead_s=2)"),
    ((BOTH, Choose("lead_s", 0), *LOOK), f"twin.preview({LOOKING}).commit()"),
    ((BOTH, Jog("all", -1)), "twin.preview_arms(-5, -5, -5, speed=30).commit(lead_s=2)"),
    ((*HW_ONLY, *LOOK), f"twin.hw.look({LOOKING})"),
    ((Choose("increment", 2.345), Jog("middle", -1)), "twin.sim.move(0, -2.345, 0, relative=True, speed=30)"),
    ((BOTH, OFF), "twin.disable()"),
    ((BOTH, RunCommand(Command.CALIBRATE)), "twin.calibrate()"),
    ((RunCommand(Command.RESET, side="hw"),), "twin.hw.reset()"),
    ((MakeReady("hw"),), "twin.hw.make_ready()"),
    ((BOTH, OWN), "play(twin, load('it is'), lead_s=2)"),
    ((AskLease(LeaseAction.TAKE, "sim"),), "twin.sim.lease()"),
    ((AskLease(LeaseAction.WAIT, "hw"),), "twin.hw.lease(wait_s=60)"),
]


@pytest.mark.parametrize(("given", "python"), LINES)
def test_a_request_is_a_line_of_the_program(given: tuple[Intent, ...], python: str) -> None:
    assert f"    {python}\n" in code(*given)


def code(*given: Intent, now: World | None = None) -> str:
    """Return the program so far after these presses."""
    return state_after(*given, now=now).view(now or world()).code.text


def plain(kind: type) -> type:
    """Return a class with the same functions, without the hints about parentheses, which hide their signatures."""
    names = [name for name in dir(kind) if not name.startswith("_")]
    return type(kind.__name__, (), {name: getattr(kind, name) for name in (*names, "__enter__", "__exit__")})


def test_the_program_of_each_row_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """The mocks accept only the calls of a real robot, with their arguments."""
    twin, play = create_autospec(plain(Twin), instance=True), MagicMock()
    twin.sim = twin.hw = robot = create_autospec(plain(Robot), instance=True)
    robot.lease = MagicMock()  # its decorator hides the signature
    for preview in (twin.preview, twin.preview_arms):
        preview.return_value = create_autospec(Plan, instance=True)
    twin.__enter__.return_value = twin
    monkeypatch.setattr(beatrix_zenoh, "Twin", MagicMock(return_value=twin), raising=False)
    monkeypatch.setattr("beatrix_zenoh.client.choreography.play", play)
    monkeypatch.setattr("beatrix_zenoh.client.choreography.load", MagicMock())
    for given in (*(given for given, _ in LINES), (*HW_ONLY, RunCommand(Command.HOME)), POSES):
        for mock in (twin, robot, play):
            mock.reset_mock()
        exec(compile(code(*given), "copied.py", "exec"), {})
        made = [call for mock in (twin, robot, play) for call in mock.mock_calls if "__" not in call[0]]
        assert made, given


def test_a_program_has_router_and_seat_only_if_it_would_choose_others() -> None:
    away = replace(world(), endpoint="tcp/192.168.1.2:7447", who="anna")
    assert 'with Twin("bea1", connect="tcp/192.168.1.2:7447", who="anna") as twin:' in code(now=away)
    assert 'with Twin("bea1") as twin:' in code()


# -- other seats -------------------------------------------------------------------------------------


def event(at_s: float, action: str = "pose", **fields: Any) -> Event:
    """Return an event; by default that a motion of ana was accepted."""
    at_ns = int(at_s * 1e9)
    given: dict[str, Any] = {
        "kind": EventKind.MOTION,
        "seat": "ana",
        "phase": Phase.ACCEPTED,
        "motion": 1,
        "duration": 1.2,
    }
    return Event(seq=next(SEQ), t_mono_ns=at_ns, t_wall_ns=at_ns, action=action, **given | fields)


def rows(
    *sim: Event, hw: tuple[Event, ...] = (), wall_s: float = 14.0
) -> list[tuple[str, str, str, bool | None]]:
    now = world(robot("sim", known=status("sim"), events=sim), robot("hw", events=hw), wall_s=wall_s)
    return [(row.who, row.what, row.result, row.good) for row in State().view(now).history]


def test_a_motion_of_another_seat_is_one_row_from_accepted_to_done() -> None:
    begun = event(10)
    assert rows(begun) == [("ana", "look", "under way, takes 1.2 s", None)]
    assert rows(begun, event(11.2, phase=Phase.DONE)) == [("ana", "look", "done, 1.2 s", True)]


def test_a_motion_of_both_robots_is_one_row_that_ends_with_the_later_robot() -> None:
    sim = (event(10, motion=7), event(11.2, phase=Phase.DONE, motion=7))
    assert rows(*sim, hw=(event(12, motion=3),)) == [("ana", "look", "under way, takes 1.2 s", None)]
    hw = (event(12, motion=3), event(13.2, phase=Phase.DONE, motion=3))
    assert rows(*sim, hw=hw) == [("ana", "look", "done, 1.2 s", True)]
    failed = (event(12, motion=3), event(12.2, phase=Phase.DONE, motion=3, reason=Reason.STOPPED))
    ((_, _, result, good),) = rows(*sim, hw=failed)
    assert (result.startswith("ended early: STOP was pressed"), good) == (True, False)


def test_a_stream_of_motions_is_one_row() -> None:
    stream = [event(10 + 0.05 * number, motion=number) for number in range(1, 21)]
    ends = [
        event(10.06 + 0.05 * number, motion=number, phase=Phase.DONE, reason=Reason.REPLACED)
        for number in range(1, 20)
    ]
    assert rows(*stream, *ends) == [("ana", "look (20 times)", "under way, takes 1.2 s", None)]
    last = event(12, motion=20, phase=Phase.DONE)
    assert rows(*stream, *ends, last) == [("ana", "look (20 times)", "done, 1.2 s", True)]


def test_a_stream_to_both_robots_is_one_row_even_if_one_of_them_refuses() -> None:
    sim = [event(10 + 0.2 * number, motion=number) for number in range(1, 21)]
    fine = [event(10.01 + 0.2 * number, motion=number) for number in range(1, 21)]
    assert rows(*sim, hw=(*fine,)) == [("ana", "look (20 times)", "under way, takes 1.2 s", None)]
    off = [event(at.t_wall_ns / 1e9, reason=Reason.NOT_ENABLED, detail=not_enabled().detail) for at in fine]
    ((_, what, result, good),) = rows(*sim, hw=(*off,))
    assert (what, result.startswith("refused"), good) == ("look (20 times)", True, False)


def test_different_requests_have_rows_of_their_own_newest_first() -> None:
    found = rows(
        event(10, "motion"),
        event(10.1, "STOP", kind=EventKind.STOP, phase=None, motion=0, seat="cem"),
        event(10.2, "motion", phase=Phase.DONE, reason=Reason.STOPPED),
        event(30, "motion", reason=Reason.NOT_ENABLED, detail=not_enabled().detail, motion=0),
        event(60, "motion", motion=2),
    )
    assert [(who, what) for who, what, _, _ in found] == [
        ("ana", "move"),
        ("ana", "move"),
        ("cem", "stop"),
        ("ana", "move"),
    ]
    same("state history.different requests have rows of their own newest first", found[1][2])


def test_a_stop_of_another_seat_is_not_called_refused() -> None:
    lost = event(10, "STOP", kind=EventKind.STOP, phase=None, motion=0, seat="cem", reason=Reason.BOARD_LOST)
    ((_, _, result, good),) = rows(lost)
    assert (result.startswith("not confirmed by Simulation: "), good) == (True, False)


@pytest.mark.parametrize(("seat", "who"), [("cem", ["cem"]), ("", ["unknown"]), ("ben", [])])
def test_a_stop_with_the_session_of_this_window_is_its_own_only_under_its_seat(
    seat: str, who: list[str]
) -> None:
    """Other clients can forge the session."""
    stop = event(10, "STOP", kind=EventKind.STOP, phase=None, motion=0, seat=seat, session="abc")
    now = replace(world(robot("sim", events=(stop,))), session="abc" if seat else "def")
    assert [row.who for row in State().view(now).history] == who
