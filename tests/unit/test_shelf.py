"""Programs of blocks as files: names, sizes, versions, damaged files, and whose programs a page opens."""

from __future__ import annotations

import hashlib
import json
import os
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from beatrix_zenoh.blocks.program import BYTES_MAX
from gui.page.messages import SaveProgram
from gui.page.shelf import PROGRAMS_MAX, SAVES_MAX, VERSIONS_MAX, Desk, NotKept, Opened, Shelf
from gui.page.static_files import STATIC

START = {"type": "start", "id": "s"}
EMPTY = json.dumps({"blocks": {"blocks": [START]}})
HOME = json.dumps({"blocks": {"blocks": [{**START, "next": {"block": {"type": "home", "id": "h"}}}]}})


@pytest.fixture
def shelf(tmp_path: Path) -> Shelf:
    return Shelf(tmp_path / "programs")


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Make names of versions and pauses between saves follow one number (s)."""
    now = [time.time()]
    clock = SimpleNamespace(time=lambda: now[0], strftime=lambda _: f"{now[0]:015.0f}")
    monkeypatch.setattr("gui.page.shelf.time", clock)
    return now


def refusal(shelf: Shelf, name: str, program: str = EMPTY) -> str:
    """Return the key of the sentence with which a program is not kept."""
    with pytest.raises(NotKept) as caught:
        shelf.keep("ana", name, program)
    return caught.value.key


def versions(shelf: Shelf, name: str) -> list[str]:
    return [path.read_text() for path in sorted((shelf.folder / "ana/versions").glob(f"{name}.*.json"))]


@pytest.mark.parametrize("name", ["a", "My dance 2", "Mädchen-Tanz", "ночь", "x" * 40, "  edges  ", "a_b"])
def test_a_program_is_kept_and_read_under_its_name(shelf: Shelf, name: str) -> None:
    kept = shelf.keep("ana", name, HOME)
    assert (kept, shelf.names("ana")) == (name.strip(), (name.strip(),))
    assert (shelf.read("ana", kept), shelf.newest("ana")) == (HOME, kept)


@pytest.mark.parametrize(
    "name",
    [
        *("", " ", ".", "..", "../ben/x", "/etc/passwd", "a/b", "a\\b", "C:x", ".hidden", "a.json", "a\0b"),
        *("a\nb", "x" * 41, "*", "?", "con", "LPT1", "\u202eevil", "a:b", '"', "%2e%2e", "~"),
    ],
)
def test_a_hostile_name_is_refused_and_writes_nothing(shelf: Shelf, tmp_path: Path, name: str) -> None:
    assert refusal(shelf, name) == "page.program_name"
    with pytest.raises(NotKept):
        shelf.read("ana", name)
    assert list(tmp_path.rglob("*")) == []


@settings(max_examples=50)
@given(st.text(max_size=60))
def test_any_name_stays_in_the_folder_of_its_seat(
    tmp_path_factory: pytest.TempPathFactory, name: str
) -> None:
    shelf = Shelf(tmp_path_factory.mktemp("any") / "programs")
    try:
        kept = shelf.keep("ana", name, HOME)
    except NotKept:
        assert not shelf.folder.exists()
    else:
        assert shelf.read("ana", kept) == HOME
        assert [path.parent for path in shelf.folder.rglob("*.json")] == [shelf.folder / "ana"]


def test_large_and_too_many_programs_are_refused_with_what_was_kept_before(shelf: Shelf) -> None:
    shelf.keep("ana", "old", HOME)
    assert refusal(shelf, "old", "x" * (BYTES_MAX + 1)) == "page.program_large"
    assert refusal(shelf, "old", "\ud800") == "page.program_not_written"
    assert shelf.read("ana", "old") == HOME
    for number in range(PROGRAMS_MAX - 1):
        shelf.keep("ana", f"p{number}", EMPTY)
    assert refusal(shelf, "one more") == "page.program_many"
    assert shelf.keep("ana", "OLD", EMPTY) == "old"
    assert shelf.keep("ben", "one more", EMPTY) == "one more"


def test_a_version_is_kept_once_a_minute_and_at_each_run(shelf: Shelf, clock: list[float]) -> None:
    def keep(program: str, after_s: float, *, ran: bool = False) -> None:
        clock[0] += after_s
        shelf.keep("ana", "dance", program, ran=ran)
        for path in (shelf.folder / "ana/versions").glob(f"*{clock[0]:015.0f}.json"):
            os.utime(path, (clock[0], clock[0]))

    keep("1", 0)
    keep("2", 1)
    assert versions(shelf, "dance") == ["1"]
    keep("3", 30)
    keep("4", 30)
    assert versions(shelf, "dance") == ["1", "3"]
    keep("5", 1, ran=True)
    keep("5", 1, ran=True)
    assert versions(shelf, "dance") == ["1", "3", "5"]
    for number in range(20):
        keep(f"new {number}", 61)
    assert versions(shelf, "dance") == [f"new {number}" for number in range(19 - VERSIONS_MAX, 19)]


@pytest.mark.parametrize(
    "content", [b"", b'{"blocks": ', b"[]", b"\xff\xfe\0", b"[" * 60000, b"x" * (BYTES_MAX + 1)]
)
def test_a_damaged_file_is_named_and_stays(shelf: Shelf, content: bytes) -> None:
    shelf.keep("ana", "torn", HOME)
    path = shelf.folder / "ana/torn.json"
    path.write_bytes(content)
    desk = Desk(shelf, "ana")
    assert (desk.opened, desk.view.note[0]) == (Opened(), "page.program_unreadable")
    assert (desk.view.names, path.read_bytes()) == (("torn",), content)


def test_a_folder_that_cannot_be_written_is_a_sentence(shelf: Shelf) -> None:
    shelf.folder.write_text("a file in place of the folder")
    assert refusal(shelf, "dance") == "page.program_not_written"
    assert Desk(shelf, "ana").view.names == ()


def test_a_page_opens_the_program_that_its_seat_had_open_last(shelf: Shelf) -> None:
    for moment, name in enumerate(("first", "second", "third")):
        shelf.keep("ana", name, EMPTY if name == "first" else HOME)
        os.utime(shelf.folder / f"ana/{name}.json", (moment, moment))
    desk = Desk(shelf, "ana")
    assert desk.opened == Opened("third", "", HOME)
    os.utime(shelf.folder / "ana/third.json", (2, 2))  # the clock of a file system may be coarse
    desk.open("first")
    assert Desk(shelf, "ana").opened == Opened("first", "", EMPTY)
    desk.save(SaveProgram("copy", HOME, opens=True))
    assert (desk.opened.name, desk.view.names) == ("copy", ("copy", "first", "second", "third"))
    assert "robot.home()" in desk.view.python


def test_only_the_teacher_opens_programs_of_other_seats(shelf: Shelf) -> None:
    shelf.keep("ben", "secret", HOME)
    shelf.keep("teacher", "own", EMPTY)
    pupil, teacher = Desk(shelf, "ana"), Desk(shelf, "teacher", teacher=True)
    assert (pupil.view.others, teacher.view.others) == ((), (("ben", "secret"),))
    for seat in ("ben", "../programs/ben", "", "ana"):
        pupil.open("secret", seat)
        assert pupil.opened == Opened()
    teacher.open("secret", "ben")
    assert teacher.opened == Opened("secret", "ben", HOME)
    shelf.keep("cem", "new", HOME)
    teacher.open("")
    assert (len(teacher.view.others), teacher.opened.owner) == (2, "ben")
    teacher.open("secret", "..")
    assert teacher.view.note[0] == "page.program_foreign"


def test_a_page_that_saves_too_often_is_refused(shelf: Shelf) -> None:
    desk = Desk(shelf, "ana")
    notes = []
    for number in range(SAVES_MAX + 1):
        desk.save(SaveProgram(f"p{number}", EMPTY))
        notes.append(desk.view.note[0])
    assert notes == ["page.program_saved"] * SAVES_MAX + ["page.program_too_often"]


def test_the_vendored_files_are_those_of_the_release() -> None:
    folder = STATIC / "vendor/blockly-12.5.1"
    lines = [
        line.split() for line in (folder / "SHA256SUMS").read_text().splitlines() if line[:1] not in ("#", "")
    ]
    files = {path.relative_to(folder).as_posix(): path for path in folder.rglob("*") if path.is_file()}
    sums = {name: hashlib.sha256(path.read_bytes()).hexdigest() for name, path in files.items()}
    assert {name: given for given, name in lines} == {
        name: one for name, one in sums.items() if name != "SHA256SUMS"
    }
