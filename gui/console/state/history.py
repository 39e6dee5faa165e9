"""The history: requests of this window with their outcomes, those of other seats, and the program so far."""

from __future__ import annotations

import math
from datetime import datetime
from functools import lru_cache
from pathlib import Path

from beatrix_zenoh.client.degrees import arm_angles
from beatrix_zenoh.contract._generated.messages import (
    Command,
    Event,
    LeaseAction,
    MotionQuery,
    PoseQuery,
    Reason,
)
from beatrix_zenoh.contract.names import SIDES
from gui.console.state import actions, code_lines, other_seats
from gui.console.state.actions import Govern, Outcome, Play, Send, SendStop
from gui.console.state.gestures import title
from gui.console.state.memory import CHEER, Memory, RequestRow
from gui.console.state.refusals import reason_of, sentence, side_of, told_by
from gui.console.state.views import HistoryRowView
from gui.console.state.world import Trouble, World, news
from gui.console.texts import Texts

SHOWN = 100
"""Largest number of rows of the view."""
SYMBOLS = {True: "✓", False: "✕", None: "…"}
PLAIN = {
    actions.MakeReady: "what.ready",
    actions.RunBlocks: "what.blocks",
    actions.FetchGestures: "what.fetch",
}
STOPS = {Command.STOP.name, Command.EMERGENCY_STOP.name}


def view(memory: Memory, world: World) -> tuple[HistoryRowView, ...]:
    """Return the rows of this window and of other seats, newest first."""
    code = memory.choices.language
    made_from = (memory.rows, world.sim.events, world.hw.events, world.seat, world.session, code)
    return memory.history.get(made_from, lambda: _rows(memory, world, code))


def _rows(memory: Memory, world: World, code: str) -> tuple[HistoryRowView, ...]:
    own = [(row.began_s, row_view(row, code)) for row in memory.rows[-SHOWN:]]
    others = [(group.began_s, _foreign(group, Texts(code))) for group in other_seats.groups(world)]
    newest_last = sorted([*others, *own], key=lambda entry: entry[0])[-SHOWN:]
    return tuple(seen for _, seen in reversed(newest_last))


def last(memory: Memory, world: World) -> str:
    """Return one line: a new error of a child program, else the last request with its outcome."""
    texts = memory.choices.texts
    for key, told in _news(memory, world):
        if isinstance(told, Trouble):
            return texts(key, text=texts(told.key, code=told.code, **told.slots))
        return texts(key, file=str(told))
    row = next((row for row in reversed(memory.rows) if row.control != CHEER), None)
    if row is None:
        return texts("last.none")
    text, _ = result(row, texts)
    first, _, _ = text.partition(". ")  # the first sentence; other places also show the advice
    shown = {"what": what(row, texts), "result": first.removesuffix(".")}
    if not row.sides:  # a request without robots, such as a file to write
        return texts("last.here", **shown)
    return texts("last", sides=sides_text(row.sides, texts), **shown)


def last_detail(memory: Memory, world: World) -> str:
    """Return the output of the program whose failure is the last line, in English; empty if it is no failure."""
    return "".join(told.detail for _, told in _news(memory, world)[:1] if isinstance(told, Trouble))


def _news(memory: Memory, world: World) -> list[tuple[str, Trouble | Path]]:
    """Return what has happened since the newest request, the most important first, by the key of its text."""
    return [(key, told) for key, told in news(world).items() if told != memory.news.get(key)]


@lru_cache(maxsize=SHOWN)
def row_view(row: RequestRow, code: str) -> HistoryRowView:
    """Return the view of a row of this window in a language."""
    texts = Texts(code)
    text, good = result(row, texts)
    on_purpose = _ended_on_purpose(row)
    return HistoryRowView(
        row=row.number,
        time=clock(row.began_s),
        who=texts("who.you"),
        what=_what_of(row, texts),
        result=text,
        symbol="–" if on_purpose else SYMBOLS[good],
        good=good,
        on_purpose=on_purpose,
    )


def _foreign(group: other_seats.Group, texts: Texts) -> HistoryRowView:
    began, query = group.began, group.query
    if query is not None and (query.absolute or isinstance(query, MotionQuery)):
        text = _motion(query, texts)
    else:
        key = other_seats.WHATS.get(began.action, "")
        text = texts(key) if key else began.action
    if group.count > 1:
        text = texts("what.times", what=text, count=float(group.count))
    unknown = "who.unknown" if began.action == Command.STOP.name else "who.none"
    result, good = _foreign_result(group, group.newest, texts)
    who = began.seat or texts(unknown)
    return HistoryRowView(-1, clock(group.began_s), who, text, result, SYMBOLS[good], good)


def _foreign_result(group: other_seats.Group, newest: Event, texts: Texts) -> tuple[str, bool | None]:
    if group.under_way:
        return texts("result.accepted", seconds=float(newest.duration)), None
    if newest.reason is Reason.OK:
        key = "result.done_in" if newest.duration else "result.done"
        return texts(key, seconds=float(newest.duration)), True
    text = sentence(newest.reason, newest.detail, newest.message, texts)
    if newest.action in STOPS:
        return texts("result.stop_missed", robots=texts(f"side.{group.side}"), text=text), False
    return failure(newest.reason, text, texts, began=group.ended), False


def failure(reason: Reason, text: str, texts: Texts, *, began: bool) -> str:
    """Return the result of a request that was refused or, if `began`, did not reach its goal."""
    if reason is Reason.REPLACED:
        return texts("result.replaced")
    return texts("result.ended" if began else "result.refused", text=text)


def clock(wall_s: float) -> str:
    """Return the local time of day; empty if unknown."""
    return f"{datetime.fromtimestamp(wall_s).astimezone():%H:%M:%S}" if wall_s > 0 else ""


def sides_text(sides: tuple[str, ...], texts: Texts) -> str:
    """Return the robots in a word or two."""
    if len(sides) > 1:
        return texts("sides.both")
    return texts(f"sides.{sides[0]}") if sides else texts("sides.none")


def result(row: RequestRow, texts: Texts) -> tuple[str, bool | None]:
    """Return the result of a request as text, and whether it succeeded (None: it has not ended)."""
    bad = [outcome for outcome in row.outcomes.values() if not outcome.accepted]
    if bad:
        return _bad(row, bad, texts), False
    longest_s = float(max((outcome.duration_s for outcome in row.outcomes.values()), default=0.0))
    robots = sum(outcome.robots for outcome in row.outcomes.values())
    if row.ended and robots > 1:
        return texts("result.done_robots", count=float(robots)), True
    if row.ended:
        return _done(row, longest_s, texts), True
    if not row.outcomes:
        return texts("result.sent"), None
    if longest_s:
        return texts("result.accepted", seconds=longest_s), None
    return texts("result.accepted_plain"), None


def _done(row: RequestRow, seconds: float, texts: Texts) -> str:
    """Return that a request is done, or that a program has ended, perhaps because the user ended it."""
    ran = isinstance(row.request, actions.RunProgram)
    if not seconds:
        return texts("result.ran" if ran else "result.done")
    return texts("result.ran_in" if ran else "result.done_in", seconds=seconds)


def _bad(row: RequestRow, bad: list[Outcome], texts: Texts) -> str:
    """Return the cause of a failure.

    If one robot refuses, the window stops the other robot; that STOP is not the cause.
    """
    worst = next((outcome for outcome in bad if outcome.reason is not Reason.STOPPED), bad[0])
    if done := worst.robots - len(worst.failed):
        slots = {"done": float(done), "count": float(worst.robots)}
        return texts("result.done_partly", text=told_by(worst, (), texts), **slots)
    if isinstance(row.request, SendStop):  # no robot refuses STOP
        missed = {side_of(outcome) for outcome in bad} - {""} or {*SIDES}
        robots = worst.failed or [texts(f"side.{side}") for side in SIDES if side in missed]
        return texts("result.stop_missed", robots=", ".join(robots), text=reason_of(worst, texts))
    if row.dropped and worst.reason is Reason.STOPPED:
        return texts(f"result.{row.dropped}")
    began = worst.side in row.accepted or "" in row.accepted
    return failure(worst.reason, told_by(worst, row.sides, texts), texts, began=began)


def _ended_on_purpose(row: RequestRow) -> bool:
    """Return whether a newer motion of this window has replaced a request, or the user has aborted it."""
    bad = [outcome.reason for outcome in row.outcomes.values() if not outcome.accepted]
    aborted = {Reason.REPLACED, *([Reason.STOPPED] if row.dropped == "aborted" else [])}
    return bool(bad) and set(bad) <= aborted


def _what_of(row: RequestRow, texts: Texts) -> str:
    """Return a request in a few words, with the robot if the request is for one robot."""
    text = what(row, texts)
    return texts("what.of", what=text, side=texts(f"sides.{row.sides[0]}")) if len(row.sides) == 1 else text


def what(row: RequestRow, texts: Texts) -> str:
    """Return a request in a few words."""
    key, slots = PLAIN.get(type(row.request), ""), dict[str, str]()
    match row.request:
        case Send(query=query):
            return _motion(query, texts)
        case Govern():
            return _governed(row.request, texts)
        case Play():
            return _played(row.request, texts)
        case actions.SendCommand(command=command, value=value):
            on = value or command is not Command.ENABLE
            key = other_seats.WHATS[command.name] if on else "what.disable"
        case SendStop(everywhere=everywhere, emergency=emergency):
            verb = "emergency_stop" if emergency else "stop"
            key = f"what.{verb}_all" if everywhere else f"what.{verb}"
        case actions.AskLease(action=action):
            key = other_seats.WHATS[action.value]
        case actions.RunProgram(file=file):
            known = {actions.FOLLOW: "what.follow_face", actions.TURN: "what.turn_to_sound"}
            key, slots = known.get(file, "what.program"), {"title": file.name}
        case actions.WriteFile(file=file):
            key, slots = "what.save", {"title": file.name}
        case actions.KeepGesture(name=name, instead=old):
            key, slots = ("what.save", {"title": name}) if name else ("what.delete", {"title": old})
        case actions.ShareGesture(name=name):
            key, slots = "what.share", {"title": name}
    return texts(key, **slots)


def _motion(query: MotionQuery | PoseQuery, texts: Texts) -> str:
    if isinstance(query, PoseQuery):
        return texts("what.look" if query.absolute else "what.look_by", way=_way(query, texts))
    arms = arm_angles(query.position)
    if query.absolute and not any(arms):
        return texts("what.home")
    short, middle, long = (_number(angle, texts, signed=not query.absolute) for angle in arms)
    key = "what.move" if query.absolute else "what.move_by"
    return texts(key, short=short, middle=middle, long=long)


def _way(query: PoseQuery, texts: Texts) -> str:
    """Return the directions of a look, for example `left 26, up 8` (deg); those below 0.05° are left out."""
    words = (("left", "right"), ("down", "up"), ("tilt_right", "tilt_left"))
    angles = (round(math.degrees(angle), 1) for angle in (query.yaw, query.pitch, query.roll))
    ways = (
        texts(f"way.{positive if angle > 0 else negative}", angle=_number(abs(angle), texts))
        for (positive, negative), angle in zip(words, angles, strict=True)
        if angle
    )
    return ", ".join(ways) or texts("way.ahead")


def _played(request: Play, texts: Texts) -> str:
    if request.gesture:
        return texts("what.gesture", title=title(request.gesture, texts))
    count = len(request.poses)
    return texts("what.play_pose" if count == 1 else "what.play_poses", count=float(count))


def _governed(request: Govern, texts: Texts) -> str:
    """Return a request to several robots in a few words."""
    text = texts(other_seats.WHATS[request.action.value])
    if request.action is LeaseAction.LIMIT:
        speed = math.degrees(request.speed)
        text = texts("what.limit_to", speed=speed) if speed else texts("what.limit_off")
    if request.seat:
        text += f" {request.seat}"
    if not request.places:
        return texts("what.for_all", what=text)
    robots = ", ".join(f"{name} ({texts(f'sides.{side}')})" for name, side in request.places)
    return texts("what.for", what=text, robots=robots)


def _number(value: float, texts: Texts, *, signed: bool = False) -> str:
    """Return an angle (deg) with at most one decimal; an increment gets its sign."""
    rounded = round(value, 1) + 0.0
    text = texts("figure", value=rounded)
    return f"+{text}" if rounded > 0 and signed else text


# -- the program so far -------------------------------------------------------------------------------


def code(memory: Memory, world: World) -> str:
    """Return the program so far, as the text of a file."""
    made_from = (memory.rows, world.robot, world.endpoint, world.who, memory.choices.language)
    return memory.code.get(made_from, lambda: _program(memory, world))


def _program(memory: Memory, world: World) -> str:
    texts = memory.choices.texts
    lines = [line for row in memory.rows if row.control != CHEER for line in _lines(row, texts)]
    return code_lines.program(lines, world, texts("code.title", robot=world.robot))


def _lines(row: RequestRow, texts: Texts) -> list[str]:
    """Return the lines of one row; a request that did not do what was asked is a comment.

    A play that repeats always ends early, so its lines play it once.
    """
    request = row.request
    calls = code_lines.python(request).splitlines()
    if not calls and not isinstance(request, SendStop):
        return []  # it is no request to the robot of the window, or has no line of Python
    text, good = result(row, texts)
    repeated = isinstance(request, Play) and bool(request.again) and bool(row.accepted)
    if calls and (good is not False or repeated):
        return calls
    first, _, _ = text.partition(". ")
    comment = " ".join(f"# {what(row, texts)}: {first}".split())
    return [comment.removesuffix(".")]
