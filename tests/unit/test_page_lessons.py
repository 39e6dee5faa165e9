"""Lessons of a page, without a robot: hints, progress, and requests that no lesson can answer."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import pytest

from gui.console.state.intents import RunBlocks
from gui.page import lessons_face, messages
from gui.page.lessons_face import CheckView, Lessons
from gui.page.messages import AskHint, CheckProgram


class PageFace:
    """As much of a face as lessons use; it drives no robot."""

    def __init__(self, language: str = "en") -> None:
        self.robot, self.driver, self.own_link, self.done = "p01", None, None, list[object]()
        texts = SimpleNamespace(code=language)
        self.state = SimpleNamespace(choices=SimpleNamespace(texts=texts, sides=("sim",)))

    def carry_out(self, intent: object) -> None:
        self.done.append(intent)


def asked(lessons: Lessons, name: str, face: Any) -> None:
    lessons.hint(face, AskHint(name))


def test_hints_come_one_after_the_other_in_the_language_of_the_page_and_are_kept(tmp_path: Path) -> None:
    lessons, face = Lessons(tmp_path / "p01", lambda *_: None), PageFace()
    assert lessons.states("en") == {}
    for more in (2, 1, 0, 0):
        asked(lessons, "b6-edge", face)
        assert lessons.states("en")["b6-edge"].more == more
    again = Lessons(tmp_path / "p01", lambda *_: None).states("de")["b6-edge"]
    assert (again.passed, again.tries, len(again.hints)) == (False, 0, 3)
    assert again.hints[0].startswith("Eine Ablehnung ist kein Fehler")
    assert Lessons(tmp_path / "p02", lambda *_: None).states("en") == {}


@pytest.mark.parametrize("name", ["03-arms", "b9", "..", "../p02", "b6-edge/check.py"])
def test_other_lessons_have_no_hints_and_no_check(name: str, tmp_path: Path) -> None:
    lessons, face = Lessons(tmp_path / "p01", lambda *_: None), PageFace()
    asked(lessons, name, face)
    lessons.check(face, CheckProgram(name, "{}"))  # type: ignore[arg-type]
    assert face.done == [RunBlocks("{}")]
    assert lessons.check_view == CheckView()
    assert [*tmp_path.iterdir()] == []


def test_a_page_that_does_not_drive_is_told_so_by_the_run_itself(tmp_path: Path) -> None:
    lessons, face = Lessons(tmp_path, lambda *_: None), PageFace()
    lessons.check(face, CheckProgram("01-hello", "{}"))  # type: ignore[arg-type]
    assert face.done == [RunBlocks("{}")]
    assert not lessons.check_view.checks


@pytest.mark.parametrize("content", ["", "{", '{"lessons": 3}', "[" * 9000, "\0"])
def test_a_damaged_progress_file_ends_no_page(content: str, tmp_path: Path) -> None:
    (tmp_path / "progress.json").write_text(content, encoding="utf-8")
    lessons = Lessons(tmp_path, lambda *_: None)
    asked(lessons, "01-hello", PageFace())
    assert lessons.states("en") == {}
    assert (tmp_path / "progress.json").read_text(encoding="utf-8") == content


def test_messages_and_texts_are_those_of_the_page() -> None:
    assert messages.read('{"do": "hint", "lesson": "b6-edge"}') == AskHint("b6-edge")
    with pytest.raises(msgspec.DecodeError):
        messages.read(f'{{"do": "hint", "lesson": "{"b" * 33}"}}')
    found = msgspec.json.decode(lessons_face.pages("de"))
    assert found[0]["name"] == "01-hello"
