"""Sentences: every language has every entry with the same fields, made from reason and detail only."""

from __future__ import annotations

import itertools
import math
import string
from collections import Counter

import pytest
from golden import same
from hypothesis import example, given
from hypothesis import strategies as st
from msgspec import structs

from beatrix_zenoh import BeatrixError, NoAnswer, Refused
from beatrix_zenoh.contract import codec, refusals, sentences
from beatrix_zenoh.contract._generated.messages import Alternative, Detail, Head, Limit, Reason, Vector3
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.contract.sentences import templates
from beatrix_zenoh.lessons.phrases import error_data, said
from gui.console import texts

LANGUAGES = {code: texts.load(code)[1] for code in texts.LANGUAGES}
RAD = math.radians
HERE = Vector3(RAD(10), RAD(-20), RAD(30.25))


def pose(
    reason: Reason, limit: Limit, value: float | None, *, at_goal: bool, leaves_s: float = 0.521
) -> Refused:
    gap = limit is Limit.ARM_GAP
    low, high = {
        Limit.TILT: (None, RAD(35)),
        Limit.YAW: (-math.pi, math.pi),
        Limit.ARM_GAP: (RAD(30), None),
    }[limit]
    detail = Detail(
        limit=limit,
        value=value,
        low=low,
        high=high,
        unit="rad",
        arms=["short", "middle"] if gap else [],
        at_goal=at_goal,
        leaves_s=leaves_s,
        leaves_arms=HERE,
        alternative=Alternative(arms=HERE, head=None if gap else Head(RAD(1), RAD(34), 0.0)),
    )
    return Refused(reason, detail=detail)


def speed(value: float, high: float, arms: list[str], other: float | None = None, field: str = "") -> Refused:
    detail = Detail(
        limit=Limit.SPEED,
        value=value,
        low=RAD(0.0215),
        high=high,
        unit="rad/s",
        arms=arms,
        field=field,
        alternative=None if other is None else Alternative(speed=Vector3(other, other, other)),
    )
    return Refused(Reason.SPEED_LIMIT, detail=detail)


REFUSALS: list[BeatrixError] = [
    refusals.not_enabled(),
    refusals.not_calibrated(),
    refusals.emergency_latched(),
    refusals.driven_by("ana"),
    refusals.driven_by("ana", 1.23),
    refusals.taken_by("ana"),
    refusals.lease_ended(3, "ana", by_teacher=False),
    refusals.lease_ended(3, "ana", by_teacher=True),
    Refused(Reason.FROZEN),
    Refused(Reason.FOLLOWING),
    refusals.muted("ana"),
    refusals.muted("ana", stop=True),
    Refused(Reason.MUTED),
    Refused(Reason.TEACHER_ONLY, detail=Detail(needs=["RESET"])),
    refusals.emergency_latched("teacher"),
    Refused(Reason.TEACHER_ONLY, detail=Detail(holder="ana")),
    Refused(Reason.BUSY, detail=Detail(holder="ana")),
    refusals.stopped_pause("ana", 3.0),
    refusals.stopped_pause("ana", 3.0, again=True),
    refusals.stopped_pause("ana", 3.0, presser="ben"),
    refusals.stopped_pause("ana", 3.0, again=True, presser="ben"),
    refusals.coming_to_rest(),
    refusals.coming_to_rest("ben"),
    refusals.queue_full(64),
    Refused(Reason.REPLACED),
    Refused(Reason.SHUTDOWN),
    Refused(Reason.CLIENT_LOST),
    Refused(Reason.UNKNOWN_COMMAND, detail=Detail(value=float(9), known=refusals.COMMANDS)),
    refusals.home_known((0.1, -0.5, 0.2), RAD(2)),
    Refused(Reason.NOT_AT_REST),
    refusals.bad_field("speed"),
    refusals.bad_field("gait", known=["speed", "yaw"]),
    Refused(Reason.BAD_VALUE, detail=Detail(field="beatrix/**", known=["beatrix/bea/sim/cmd/me/motion"])),
    Refused(Reason.TIMED_OUT, detail=Detail(limit=Limit.DURATION, value=121.0, high=60.0, unit="s")),
    refusals.too_far((0.0, 50.0, 1.0), 49.2),
    refusals.too_far_for_any_pose((0.0, -7.0, 1.0), 6.3),
    Refused(
        Reason.BAD_VALUE,
        detail=Detail(limit=Limit.TILT, value=RAD(35), high=RAD(29), unit="rad", field="tilt_max"),
    ),
    Refused(Reason.UNKNOWN_COMMAND, detail=Detail(field="enabel", known=refusals.COMMANDS)),
    *(
        pose(Reason.OUT_OF_REACH, Limit.TILT, value, at_goal=at_goal)
        for value in (RAD(40), None)
        for at_goal in (True, False)
    ),
    pose(Reason.OUT_OF_REACH, Limit.TILT, None, at_goal=False, leaves_s=0.0),
    *(
        pose(Reason.ARM_GAP, Limit.ARM_GAP, value, at_goal=at_goal)
        for value in (RAD(12), RAD(-3))
        for at_goal in (True, False)
    ),
    *(pose(Reason.YAW_LIMIT, Limit.YAW, RAD(-200), at_goal=at_goal) for at_goal in (True, False)),
    speed(RAD(0.01), RAD(90), ["short", "long"], RAD(0.022)),
    speed(RAD(100), RAD(90), ["short", "long"], RAD(90)),
    *(
        speed(RAD(60), RAD(31), ["long"], field=field)
        for reason, _, field in sentences.ENGLISH.refusals
        if reason is Reason.SPEED_LIMIT and field not in ("", "low", "high")
    ),
    NoAnswer(Reason.NO_ANSWER, detail=Detail(field="ana (hw)")),
    NoAnswer(Reason.NO_ANSWER, detail=Detail(field="ana (hw)", known=["ana (sim)"])),
    NoAnswer(Reason.NO_SUCH_ROBOT, detail=Detail(field="ana (hw)", known=["bea1 (sim)", "bea2 (hw)"])),
    NoAnswer(Reason.NO_ANSWER, detail=Detail(field="ana (hw)", known=["ana (hw)"])),
    NoAnswer(Reason.NO_ANSWER, detail=Detail(field="ana (hw)", holder="ben")),
    NoAnswer(Reason.NO_ANSWER, detail=Detail(field="ana (hw)", known=["ana (sim)"], holder="ben")),
    NoAnswer(Reason.NODE_LOST, detail=Detail(field="ana (hw)")),
    NoAnswer(Reason.NODE_LOST, detail=Detail(field="ana (hw)", known=["ana (hw)"])),
    NoAnswer(Reason.NODE_HANGS, detail=Detail(field="ana (hw)", value=2.0, unit="s")),
    NoAnswer(Reason.TIMED_OUT, detail=Detail(field="ana (hw)", value=0.5, unit="s")),
    NoAnswer(Reason.TIMED_OUT, detail=Detail(field="ana (hw)", value=2.0, unit="s", needs=["STOP"])),
    NoAnswer(Reason.ACCESS_DENIED, detail=Detail(field="ana (hw)", holder="ben")),
    *(Refused(reason) for reason in Reason),
]


def key_of(refusal: BeatrixError) -> tuple[Reason, Limit | None, str]:
    detail = refusal.detail
    if detail is None:
        return refusal.reason, None, ""
    return refusal.reason, detail.limit, sentences.case_of(refusal.reason, detail)


def fields(template: str) -> set[str]:
    return {name for _, name, _, _ in string.Formatter().parse(template) if name}


def test_the_refusals_of_this_file_cover_every_sentence() -> None:
    assert {key_of(refusal) for refusal in REFUSALS} == set(LANGUAGES["en"].refusals)


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_language_has_every_sentence_with_the_same_fields(language: str) -> None:
    english, other = LANGUAGES["en"], LANGUAGES[language]
    assert set(other.refusals) == set(english.refusals)
    for key, template in english.refusals.items():
        assert fields(other.refusals[key]) == fields(template), key
    for name in ("leaves", "head", "position", "speed", "nothing"):
        assert fields(getattr(other, name)) == fields(getattr(english, name)), name
    assert set(other.arms) == set(english.arms) == set(ARMS)
    assert set(other.commands) == set(english.commands)


@pytest.mark.parametrize("language", LANGUAGES)
def test_sentences_are_those_of_the_golden_file(language: str) -> None:
    count: Counter[str] = Counter()
    for refusal in REFUSALS:
        reason, limit, case = key_of(refusal)
        name = " ".join(filter(None, (reason.name, limit.name if limit else "", case)))
        count[name] += 1
        same(
            f"{language}.{name} {count[name]}",
            sentences.render(refusal.reason, refusal.detail, LANGUAGES[language]),
        )


def test_lessons_make_every_sentence_in_their_language_from_its_data() -> None:
    german = sentences.language("de")
    for refusal in REFUSALS:
        data = error_data(refusal)
        own = sentences.render(refusal.reason, refusal.detail, german)
        assert said(data) == f"{type(refusal).__name__}: {refusal.message}"
        assert said(data, "de") == f"{type(refusal).__name__}: {own}"
        named = structs.replace(data.unnamed, message=f"bea1 (sim): {refusal.message}")
        assert said(named, "de") == f"bea1 (sim): {own}"


@pytest.mark.parametrize("language", LANGUAGES)
def test_an_empty_detail_has_a_sentence(language: str) -> None:
    for reason, limit in itertools.product(Reason, [None, *Limit]):
        assert sentences.render(reason, Detail(limit=limit), LANGUAGES[language]), (reason, limit)


@given(
    st.floats(1e-3, 400),
    st.floats(1e-4, 0.5) | st.floats(-0.5, -1e-4),
)
def test_a_refused_number_is_shown_on_its_side_of_the_limit(high: float, excess: float) -> None:
    value = high * (1 + excess)
    shown = templates.most(high) if excess > 0 else templates.least(high)
    text = templates.apart(value, [(high, shown)])
    assert (float(text) > float(shown)) == (excess > 0)
    assert float(text) != float(shown)


@given(st.integers(50, 900))
def test_a_limit_in_single_precision_is_shown_as_it_was_typed(tenths: int) -> None:
    detail = Detail(high=RAD(tenths / 10), low=RAD(tenths / 10), unit="rad/s")
    read = codec.decode(codec.encode(detail), Detail)
    assert read.high is not None
    assert templates.most(math.degrees(read.high)) == f"{tenths / 10:.1f}"
    assert templates.least(math.degrees(read.high)) == f"{tenths / 10:.1f}"


@given(st.floats(1e-3, 400))
@example(0.9453125)
def test_the_shown_limit_is_allowed(limit: float) -> None:
    assert float(templates.most(limit)) <= limit * (1 + 1e-6) + 1e-6
    assert float(templates.least(limit)) >= limit * (1 - 1e-6) - 1e-6
