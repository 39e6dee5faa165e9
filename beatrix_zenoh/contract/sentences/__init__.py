"""Sentences of refusals, made from reason and detail only; in English, unless the caller has another language.

A sentence states the event, the allowed values and what to do. Its template depends on the reason, the limit and a case
that `case_of` finds from the detail; a language is a table of templates, a TOML file of this folder. Angles are rad in a detail and degrees in a
sentence.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from beatrix_zenoh.contract._generated.messages import Detail, Limit, Reason
from beatrix_zenoh.contract.sentences.templates import Language, language, slots_of

__all__ = ["ENGLISH", "case_of", "language", "render"]

ENGLISH: Final = language("en")
"""read once, at the import: no refusal waits for a file"""


def render(reason: Reason, detail: Detail | None = None, table: Language = ENGLISH) -> str:
    """Return the sentence of a refusal.

    If the detail lacks a value of the template, for example because a node of another version sent it, the result is
    the general sentence of the reason.
    """
    if detail is None:
        return table.refusals[reason, None, ""]
    slots = slots_of(detail, table)
    try:
        text = table.refusals[reason, detail.limit, case_of(reason, detail)].format_map(slots)
    except KeyError:
        text = table.refusals[reason, None, ""]
    return " ".join(filter(None, (text, _leaving(detail, table, slots), _advice(detail, table, slots))))


def case_of(reason: Reason, detail: Detail) -> str:
    """Return the case, which selects one of the sentences of a reason and a limit; empty if there is only one."""
    choose = _CASES.get((reason, detail.limit))
    return choose(detail) if choose is not None else ""


def _pose_case(detail: Detail) -> str:
    if detail.value is None and detail.at_goal is False and detail.leaves_s == 0:
        return "start"
    where = "path" if detail.at_goal is False else "goal"
    if detail.value is None:
        return f"{where} unfit"
    crossed = detail.limit is Limit.ARM_GAP and detail.value <= 0
    return f"{where} crossed" if crossed else where


def _leaving(detail: Detail, table: Language, slots: dict[str, str]) -> str:
    if not detail.leaves_s or detail.leaves_arms is None:
        return ""
    return table.leaves.format_map(slots)


def _advice(detail: Detail, table: Language, slots: dict[str, str]) -> str:
    other = detail.alternative
    if other is None:
        return table.nothing if detail.leaves_s else ""
    if other.head is not None:
        return table.head.format_map(slots)
    if other.arms is not None:
        return table.position.format_map(slots)
    return table.speed.format_map(slots) if other.speed is not None else ""


def _seat_case(detail: Detail) -> str:
    if detail.field == "lease":
        if detail.value is None:
            return "taken"
        return "skipped" if detail.presser else "ended"
    if not detail.holder:
        return ""
    return "moving" if detail.wait_s is None else "wait"


def _stop_case(detail: Detail) -> str:
    case = detail.field or ("wait" if detail.holder else "")
    return " ".join(filter(None, (case, "by" if detail.presser else "")))


def _field_case(detail: Detail) -> str:
    if "*" in detail.field and "/" in detail.field:
        return "wildcard"
    return "known" if detail.known else "field"


def _absence_case(detail: Detail) -> str:
    if detail.field in detail.known:
        return "present"
    case = "absent" if detail.known else "alone"
    return f"{case} in class" if detail.holder else case


def _needs_case(detail: Detail) -> str:
    return "upright" if "CALIBRATE" in detail.needs else ""


def _speed_case(detail: Detail) -> str:
    if detail.value is None or detail.low is None:
        return ""
    if detail.value < detail.low:
        return "low"
    # the names of the limits; a newer robot may have one that this table lacks
    known = (Reason.SPEED_LIMIT, Limit.SPEED, detail.field) in ENGLISH.refusals
    return detail.field if known else "high"


_CASES: dict[tuple[Reason, Limit | None], Callable[[Detail], str]] = {
    (Reason.OUT_OF_REACH, Limit.TILT): _pose_case,
    (Reason.ARM_GAP, Limit.ARM_GAP): _pose_case,
    (Reason.YAW_LIMIT, Limit.YAW): _pose_case,
    (Reason.SPEED_LIMIT, Limit.SPEED): _speed_case,
    (Reason.BAD_VALUE, None): _field_case,
    (Reason.UNKNOWN_COMMAND, None): lambda detail: "word" if detail.field else "number",
    (Reason.NOT_ENABLED, None): _needs_case,
    (Reason.NOT_CALIBRATED, None): _needs_case,
    (Reason.EMERGENCY, None): lambda detail: "teacher" if detail.holder else _needs_case(detail),
    (Reason.NOT_HOLDER, None): _seat_case,
    (Reason.MUTED, None): lambda detail: detail.field or ("seat" if detail.holder else ""),
    (Reason.TEACHER_ONLY, None): lambda detail: "reset" if detail.needs else "seat" if detail.holder else "",
    (Reason.BUSY, None): _seat_case,
    (Reason.STOPPED, None): _stop_case,
    (Reason.NO_ANSWER, None): _absence_case,
    (Reason.NO_SUCH_ROBOT, None): lambda _: "absent",
    (Reason.NODE_LOST, None): lambda detail: "back" if detail.field in detail.known else "robot",
    (Reason.NODE_HANGS, None): lambda _: "robot",
    (Reason.TIMED_OUT, None): lambda detail: "stop" if detail.needs else "robot",
    (Reason.ACCESS_DENIED, None): lambda _: "robot",
}
"""Functions that choose the case, for each reason and limit with several sentences."""
