"""Reply and next state of each request in each state, and further rules of requests."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from firmware_host import SPEED_MAX, Rig

from beatrix_zenoh.board.link import encode
from beatrix_zenoh.board.virtual import Firmware
from beatrix_zenoh.contract._generated.serial import (
    BoardOutcome,
    BoardState,
    Error,
    FrameType,
    HelloReply,
)

OFF, ON, HOME = BoardState(0), BoardState.ENABLED, BoardState.ENABLED | BoardState.CALIBRATED
MOVING, LATCHED = HOME | BoardState.MOVING, BoardState.EMERGENCY
BRAKING = MOVING | BoardState.STOPPING
STATES = {"off": OFF, "on": ON, "home": HOME, "moving": MOVING, "braking": BRAKING, "latched": LATCHED}
REQUESTS: dict[str, Callable[[Rig], Error]] = {
    "PING": lambda rig: rig.ask(FrameType.PING),
    "MOVE": lambda rig: rig.move((500, 500, 500)),
    "STOP": lambda rig: rig.ask(FrameType.STOP),
    "EMERGENCY_STOP": lambda rig: rig.ask(FrameType.EMERGENCY_STOP),
    "ENABLE 1": lambda rig: rig.enable(1),
    "ENABLE 0": lambda rig: rig.enable(0),
    "CALIBRATE": lambda rig: rig.ask(FrameType.CALIBRATE),
    "RESET": lambda rig: rig.ask(FrameType.RESET),
}
NEXT: dict[str, list[str]] = {
    # in state:        off             on                home       moving         braking        latched
    "PING":           ["off",         "on",             "home",    "moving",      "braking",     "latched"],
    "MOVE":           ["NOT_ENABLED", "NOT_CALIBRATED", "moving",  "moving",      "moving",      "NOT_ENABLED"],
    "STOP":           ["off",         "on",             "home",    "braking",     "braking",     "latched"],
    "EMERGENCY_STOP": ["latched",     "latched",        "latched", "latched",     "latched",     "latched"],
    "ENABLE 1":       ["on",          "on",             "home",    "moving",      "braking",     "EMERGENCY"],
    "ENABLE 0":       ["off",         "off",            "off",     "off",         "off",         "latched"],
    "CALIBRATE":      ["NOT_ENABLED", "home",           "home",    "NOT_AT_REST", "NOT_AT_REST", "NOT_ENABLED"],
    "RESET":          ["off",         "on",             "home",    "moving",      "braking",     "off"],
}  # fmt: skip
"""Next state of each request in each state, or the error with which the board refuses it and keeps its state."""


def board_in(state: str) -> Rig:
    """Return a board in this state."""
    rig = Rig(Firmware())
    if state == "on":
        rig.enable()
    elif state == "latched":
        rig.ask(FrameType.EMERGENCY_STOP)
    elif state != "off":
        rig.ready()
    if state in ("moving", "braking"):
        rig.move((400, 400, 400))
        rig.tick(100)
    if state == "braking":
        rig.ask(FrameType.STOP)
    return rig


@pytest.mark.parametrize("request_name", NEXT)
@pytest.mark.parametrize("before", STATES)
def test_each_request_has_its_reply_and_next_state(before: str, request_name: str) -> None:
    rig = board_in(before)
    after = NEXT[request_name][[*STATES].index(before)]
    refused = after not in STATES
    assert REQUESTS[request_name](rig) == (Error[after] if refused else Error.OK)
    rig.tick(10)
    assert rig.state == STATES[before if refused else after]
    assert isinstance(rig.core, Firmware)
    assert rig.core.drivers_on() == bool(rig.state & BoardState.ENABLED)


def test_the_outcome_names_motors_switched_off_in_motion_and_an_emergency_stop_at_rest_keeps_it(
    ready: Rig,
) -> None:
    ready.move((10, 10, 10))
    ready.tick(50)
    ready.enable(0)
    assert (ready.state, ready.outcome) == (OFF, BoardOutcome.DISABLED)
    ready.ask(FrameType.EMERGENCY_STOP)
    assert ready.outcome == BoardOutcome.DISABLED


def test_enable_rejects_other_values_than_0_and_1(rig: Rig) -> None:
    assert rig.enable(2) == Error.BAD_VALUE


@pytest.mark.parametrize("name", [b"a", b"bea-1", b"0-9-z", b"x" * 32])
def test_a_valid_name_is_stored(rig: Rig, name: bytes) -> None:
    assert rig.ask(FrameType.SET_NAME, name.ljust(32, b"\0")) == Error.OK
    (hello,) = rig.raw(encode(FrameType.HELLO, 1, b""))
    assert HelloReply.unpack(hello.payload).name.rstrip(b"\0") == name


@pytest.mark.parametrize("name", [b"", b"Bea", b"bea_1", b"a b", b"a\0b", b"\xc3\xa9", b"\0a"])
def test_an_invalid_name_is_refused_and_the_old_one_remains(name: bytes) -> None:
    rig = Rig(Firmware(name="before"))
    assert rig.ask(FrameType.SET_NAME, name.ljust(32, b"\0")) == Error.BAD_VALUE
    (hello,) = rig.raw(encode(FrameType.HELLO, 1, b""))
    assert HelloReply.unpack(hello.payload).name.rstrip(b"\0") == b"before"


@pytest.mark.parametrize(
    ("target", "speed", "error"),
    [
        ((0, 0, 0), (1, SPEED_MAX, 1), Error.OK),
        ((0, 0, 0), (0, 1, 1), Error.SPEED),
        ((0, 0, 0), (SPEED_MAX + 1, 1, 1), Error.SPEED),
        ((0, 0, 0), SPEED_MAX, Error.OK),
        ((0, 0, 0), SPEED_MAX + 1, Error.SPEED),
        ((32767, 0, 0), 1, Error.GAP),
        ((32767, 32767, 32767), 1, Error.YAW),
        ((529, -529, 0), 1, Error.OK),
        ((530, -529, 0), 1, Error.GAP),
        ((2324, 2325, 2325), 1, Error.OK),
        ((2325, 2325, 2325), 1, Error.YAW),
        ((-2325, -2325, -2325), 1, Error.YAW),
    ],
)
def test_moves_beyond_a_limit_are_refused(
    target: tuple[int, int, int], speed: tuple[int, int, int] | int, error: Error
) -> None:
    for straight in (False, True) if isinstance(speed, int) else (False,):
        rig = Rig().ready()
        assert rig.move(target, speed, straight=straight) == error
        assert bool(rig.state & BoardState.MOVING) == (error == Error.OK)


def test_a_repeated_move_runs_once(ready: Rig) -> None:
    other = Rig().ready()
    for rig, times in ((ready, 3), (other, 1)):
        for _ in range(times):
            assert rig.move((300, -100, 7), straight=True, motion=5) == Error.OK
            rig.tick(60 // times)
    assert ready.steps == other.steps
    ready.run()
    assert (ready.steps, ready.outcome) == ((300, -100, 7), BoardOutcome.DONE)


def test_a_repeated_move_does_not_undo_a_stop(ready: Rig) -> None:
    ready.move((300, 300, 300), motion=5)
    ready.tick(100)
    ready.ask(FrameType.STOP)
    ready.run()
    at = ready.steps
    assert ready.move((300, 300, 300), motion=5) == Error.OK
    ready.tick(100)
    assert (ready.steps, ready.outcome) == (at, BoardOutcome.STOPPED)


def test_501_ms_without_a_frame_stop_the_arms_and_leave_the_motors_on_but_not_499(ready: Rig) -> None:
    ready.move((1000, 1000, 1000), 400)
    for _ in range(4):
        ready.tick(499)
        assert BoardState.STOPPING not in ready.state
        ready.ask(FrameType.PING)
    ready.tick(501)
    assert BoardState.STOPPING in ready.state
    ready.tick(200)
    assert (ready.state, ready.outcome) == (HOME, BoardOutcome.HOST_LOST)


@pytest.mark.parametrize("echo", [False, True])
def test_damaged_frames_and_an_echo_do_not_count_as_heartbeat(ready: Rig, echo: bool) -> None:
    ready.move((1000, 1000, 1000), 400)
    for _ in range(51):
        ready.tick(10)
        damaged = b"\0\x05\x02\xff\x70\xcd\0"
        ready.raw(encode(FrameType.TELEMETRY, 1, ready.last.pack()) if echo else damaged)
    assert BoardState.STOPPING in ready.state
