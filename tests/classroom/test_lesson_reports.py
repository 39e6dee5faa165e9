"""Reports of lessons and shared gestures in a class: each seat writes its own, and the teacher reads all."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from class_router import ClassRouter, replies, use_account
from patient_connections import patiently
from robots import assert_fails, until
from shell import good

from beatrix_zenoh.classroom.reports import GESTURES_MAX
from beatrix_zenoh.client import Client
from beatrix_zenoh.client import lesson_reports as reports
from beatrix_zenoh.client.own_gestures import possible
from beatrix_zenoh.client.shared_gestures import share, shared, unused
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LessonState, Reason
from beatrix_zenoh.contract.errors import Refused, WrongUsage
from beatrix_zenoh.lessons.progress import Record

STUCK = Record(tries=7, hints=[1], figure="nods", stuck=reports.STUCK)
LONG = "1.000,12.000,-12.000,0.000,30,pose\n" * 250
PASSED = Record(tries=2, passed=["0" * 64])


@pytest.fixture(scope="module")
def teacher(router: ClassRouter) -> Iterator[Client]:
    with router.client("teacher") as made:
        yield made


def test_seats_that_are_silent_or_too_busy_are_listed(
    router: ClassRouter, teacher: Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    use_account(tmp_path, router.path("ana"))
    reports.report("01-hello", Record().state(measured=False))
    until(lambda: bool(reports.read(teacher)), "the report has arrived")
    use_account(tmp_path, router.path("teacher"))
    table = patiently(lambda: good("lesson", "report")).splitlines()
    assert [line.split() for line in table[:3]] == [
        ["seat", "01-hello"],
        ["ana", "not-measured"],
        ["ben", "-"],
    ]
    assert "ana could judge nothing" in table[3]
    assert good("lesson", "report", "--csv").splitlines() == [
        ",".join(reports.FIELDS),
        "ana,01-hello,not-measured,0,0,not-measured",
        "ben,,silent,0,0,",
    ]


def test_the_teacher_reads_what_each_seat_has_reported(
    router: ClassRouter, teacher: Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for seat, record in (("ana", STUCK), ("ben", PASSED)):
        use_account(tmp_path, router.path(seat))
        reports.report("01-hello", record.state())
    expected = [("ana", "01-hello", "stuck (7)"), ("ben", "01-hello", "passed (2)")]
    until(
        lambda: [(row.seat, row.lesson, row.words) for row in reports.read(teacher)] == expected,
        "both reports",
    )
    use_account(tmp_path, router.path("ana"))
    reports.report("01-hello", PASSED.state())
    reports.report("01-hello", Record(tries=1).state())
    kept = ["passed (7)", "passed (2)"]
    until(lambda: [row.words for row in reports.read(teacher)] == kept, "reports from another folder")
    assert_fails(lambda: reports.read(router.client("ana")), Refused, Reason.TEACHER_ONLY)

    # a seat that does not ask politely
    ana, ben = router.session("ana"), router.session("ben")
    assert replies(ana, "beatrix/@lesson/**") == []  # test_access_rules.py has the other keys
    forged = codec.encode(Record(tries=1).state())
    for key in (keys.lesson("ana", "01-hello"), keys.lesson("ana", "02-steps")):
        ben.put(key, forged, codec.MSGPACK)
    for lesson, report in (
        ("03-arms", b"x" * 5000),
        ("03-arms", b"x"),
        ("99-invented", forged),
        ("*", forged),
    ):
        ben.put(keys.lesson("ben", lesson), report, codec.MSGPACK)
    router.settled(ben)
    assert [(row.seat, row.lesson, row.progress) for row in reports.read(teacher)] == [
        ("ana", "01-hello", "passed"),
        ("ben", "01-hello", "passed"),
    ]


def test_the_teacher_collects_gestures_and_hands_them_out(router: ClassRouter, teacher: Client) -> None:
    with router.client("ana") as ana, router.client("ben") as ben:
        for name, text in (("wink", "old\n"), ("wink", "new\n"), ("nod", LONG)):
            share(ana, name, text)
        share(ben, "../x", "")
        for number in range(GESTURES_MAX + 5):
            share(ben, f"g{number}", "")
        assert_fails(lambda: share(ben, "huge", 2 * LONG), WrongUsage, Reason.BAD_VALUE)
        found = shared(teacher)
        assert (found["ana-wink"], found["ana-nod"]) == ("new\n", LONG)
        assert f"ben-g{GESTURES_MAX + 4}" in found, "the newest are kept"
        assert len([name for name in found if name.startswith("ben-g")]) == GESTURES_MAX
        assert len(found) == 2 + GESTURES_MAX
        assert shared(ben) == {}
        share(teacher, "ana-wink", "new\n")
        assert shared(ben) == {"ana-wink": "new\n"}
        assert shared(teacher).keys() == found.keys()


def test_names_of_collected_gestures_are_short_and_different() -> None:
    found: dict[str, str] = {}
    for name in ("my long gesture number 1", "my long gesture number 2", "abcdefghijklmnopqr st"):
        found[unused(f"ana-{name}", found)] = ""
    assert [*found] == ["ana-my long gesture numb", "ana-my long gesture nu-2", "ana-abcdefghijklmnopqr s"]
    assert all(possible(name) for name in found)


def test_a_report_names_no_person_and_is_small() -> None:
    state = STUCK.state()
    assert state == LessonState(version=1, tries=7, hints=1, figure="nods", stuck=5, passed=False)
    assert len(codec.encode(state)) <= 100


def test_without_a_class_nothing_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("BEATRIX_ACCOUNT", "")
    monkeypatch.setattr(reports, "_publish", lambda *_: pytest.fail("published"))
    reports.report("01-hello", PASSED.state())
