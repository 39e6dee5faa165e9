"""`beatrix stop`: stop every robot that can be stopped, even if settings, files or arguments are wrong."""

from __future__ import annotations

import os
import time
from collections.abc import Collection, Sequence
from typing import Annotated, NamedTuple

import typer

from beatrix_zenoh.client.request import absent_reason
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.client.stopping import (
    IF_IT_MOVES,
    PRESS_BYTES,
    Answer,
    SentGroupStop,
    matches,
    sentence,
    silences,
)
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.messages import Reason, Source
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer, WrongUsage
from beatrix_zenoh.output import USAGE, exit_code, note, print_json, say
from beatrix_zenoh.settings import Settings, resolve_valid
from beatrix_zenoh.terminal.options import Connect, Json, Which, Who

ALL = "*"
AGAIN_S, RETURN_S, PAUSE_S = 12.0, 2.0, 0.2
"""Longest times (s) to send STOP again in a class: without its router, and without a robot, which may return a moment
later than a router that was started again; and pause before each attempt."""

Emergency = Annotated[
    bool,
    typer.Option(
        "--emergency",
        help="Switch the motors off at once; the head falls. Afterwards: beatrix reset, enable, calibrate.",
    ),
]
Names = Annotated[
    list[str] | None,
    typer.Option(
        "--name",
        metavar="ROBOT",
        help="Only robots of this name; may be given several times. Default: BEATRIX_ROBOT, beatrix.toml, every robot.",
    ),
]


class StopOutcome(NamedTuple):
    """The outcome of STOP at one robot, or for one name of the command line."""

    robot: str
    side: str
    """Empty if the name is invalid, or no robot of this name is online."""
    reason: Reason
    message: str
    code: int


def stop(
    every: Annotated[
        bool, typer.Option("--all", help="Stop every robot at the router, even if settings name one robot.")
    ] = False,
    emergency: Emergency = False,
    name: Names = None,
    connect: Connect = None,
    who: Who = None,
    on: Annotated[list[Which] | None, typer.Option("--on", help="sim or hw; default: both.")] = None,
    as_json: Json = False,
) -> None:
    """Stop robots at once, even if another seat drives them. Stops simulation and robot of a name, by default all.

    If a name is invalid or no robot of this name is online, the other robots are still stopped.
    """
    settings, wrong_settings = resolve_valid(connect=connect, who=who)
    asked, wrong_names = check_names(name or ())
    if every:
        asked = [ALL]
    elif not name:
        asked = [settings.robot if settings.named else ALL]
    if not asked:
        show(wrong_names, as_json=as_json)
    sides = {*(on or ())}
    side = "sim" if sides == {Which.SIM} else "hw" if sides == {Which.HW} else ALL
    try:
        answers, present = send(settings, asked, side, emergency=emergency)
    finally:
        for error in wrong_settings:
            note(error.message)
    missing = absent(asked, side, answers, present, settings.connect)
    if not (answers or missing or wrong_names):
        text = f"Nothing to stop: no such robot is online at {settings.connect}. {IF_IT_MOVES}"
        raise NoAnswer(absent_reason(ALL, present), text)
    found = [
        StopOutcome(
            *place,
            answer.reason,
            answer.message,
            exit_code(answer.reason) if isinstance(answer, BeatrixError) else 0,
        )
        for place, answer in answers.items()
    ]
    show([*found, *missing, *wrong_names], as_json=as_json)


def send(
    settings: Settings, asked: Sequence[str], side: str, *, emergency: bool
) -> tuple[dict[Place, Answer], Sequence[Place]]:
    """Send STOP; return the answers and the robots online.

    The router of a class is started again if it ends or is stuck, so STOP is sent again.
    """
    begin_s = time.monotonic()
    router_s, robots_s = (AGAIN_S, RETURN_S) if settings.account else (0.0, 0.0)
    while True:
        waited_s = time.monotonic() - begin_s
        try:
            answers, present = _send(settings, asked, side, emergency=emergency)
        except NoAnswer as error:
            if error.reason is not Reason.NO_ROUTER or waited_s > router_s:
                raise
            if robots_s < router_s:
                note(f"The router does not answer. STOP is sent again, for at most {AGAIN_S:.0f} s.")
            robots_s = router_s
        else:
            if answers or waited_s > robots_s:
                return answers, present
        time.sleep(PAUSE_S)


def _send(
    settings: Settings, asked: Sequence[str], side: str, *, emergency: bool
) -> tuple[dict[Place, Answer], Sequence[Place]]:
    with Client(settings, source=Source.CLI) as client:
        press = os.urandom(PRESS_BYTES)  # the same for all: robots count it once
        sent = [SentGroupStop(client, (robot, side), press, emergency=emergency) for robot in asked]
        present = client.robots()  # after STOP is sent, but before a node that hangs loses its token
        found = [place for place in present if any(matches((robot, side), place) for robot in asked)]
        if emergency:
            # The router of a class forwards none of a student to simulations of others, or with wildcards.
            sent += [SentGroupStop(client, place, press, emergency=True) for place in found]
            sims = [] if side == "hw" else asked
            sent = [*(SentGroupStop(client, (robot, "sim"), press) for robot in sims), *sent]
        answers = {place: answer for stop in sent for place, answer in stop.replies().items()}
        answers |= silences(client.bus, [place for place in found if place not in answers])
        return answers, present


def check_names(robots: Sequence[str]) -> tuple[list[str], list[StopOutcome]]:
    """Return the valid names, and an outcome for each invalid name."""
    asked, wrong = [], []
    for robot in robots:
        try:
            asked.append(names.check_name(robot))
        except WrongUsage as error:
            wrong.append(StopOutcome(robot, "", error.reason, error.message, USAGE))
    return asked, wrong


def absent(
    asked: Sequence[str], side: str, places: Collection[Place], present: Sequence[Place], endpoint: str
) -> list[StopOutcome]:
    """Return an outcome for each name in `asked` that no robot in `places` has."""
    stopped = {robot for robot, _ in places}
    side = "" if side == ALL else f" ({side})"
    online = ", ".join(f"{robot} ({side})" for robot, side in present) or "no robot"
    text = (
        f"{side} is not online at {endpoint}, so it was not stopped. Online: {online}. `beatrix stop --all` stops every robot. "
        f"{IF_IT_MOVES}"
    )
    return [
        StopOutcome(robot, "", reason, robot + text, exit_code(reason))
        for robot in asked
        if robot not in (ALL, *stopped)
        for reason in [absent_reason(robot, present)]
    ]


def show(outcomes: Sequence[StopOutcome], *, as_json: bool) -> None:
    """Print the outcomes; exit with the code of the first failure, if there is one."""
    code = next((outcome.code for outcome in outcomes if outcome.code), 0)
    if as_json:
        rows = [
            {"robot": robot, "side": side, "result": not failed, "reason": reason, "message": message}
            for robot, side, reason, message, failed in outcomes
        ]
        print_json({"result": not code, "robots": rows})
    else:
        for robot, side, _, message, failed in outcomes:
            (note if failed else say)(sentence((robot, side), message) if side else message)
    if code:
        raise typer.Exit(code)
