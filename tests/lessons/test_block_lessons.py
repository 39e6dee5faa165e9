"""Lessons for blocks: their texts, and their checks of what a robot does that runs already."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path
from types import SimpleNamespace

import pytest
from lesson_checks import BUSY_TRIES, Wrong, tidied, wrong_programs

from beatrix_zenoh import threads
from beatrix_zenoh.blocks.program import STATEMENTS, VALUES, inside, read
from beatrix_zenoh.client import lesson_reports
from beatrix_zenoh.contract._generated.messages import LessonState, Reason
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.lesson_files import LIBRARY, BlockLesson, Lesson, block_lessons, lessons, names
from beatrix_zenoh.lessons import own_run
from beatrix_zenoh.lessons.checking import Result, Verdict
from beatrix_zenoh.lessons.own_run import OwnRun
from beatrix_zenoh.lessons.page import lesson_pages, paragraphs
from beatrix_zenoh.lessons.stage import PUPIL, ROBOT, Stage
from gui.console.link.block_run import BlockRun
from gui.console.link.outcomes import WindowError
from gui.console.state.actions import RunBlocks

pytestmark = pytest.mark.timeout(200)
LESSONS = block_lessons()
FIGURE = re.compile(r'require\(\s*"([\w-]+)"')
QUICK = "b2-steps"
NODS_ONCE = """{"blocks": {"blocks": [{"type": "start", "id": "s", "next": {"block":
{"type": "nod", "id": "a", "inputs": {"ANGLE": {"shadow": {"type": "math_number", "fields": {"NUM": 12}}}},
"next": {"block": {"type": "home", "id": "b"}}}}}]}}"""


def solution(lesson: Lesson) -> str:
    return (lesson.folder / "solution.json").read_text(encoding="utf-8")


def cases() -> list[object]:
    """Return each lesson with its solution (None) and its wrong programs."""
    found: list[object] = []
    for lesson in LESSONS:
        for name, wrong in {"solution": None, **wrong_programs(f"blocks/{lesson.name}")}.items():
            always = lesson.name == QUICK and wrong is None
            marks = () if always else pytest.mark.long("programs move a robot in real time")
            found.append(pytest.param(lesson, wrong, marks=marks, id=f"{lesson.name}/{name}"))
    return found


def observed(stage: Stage, program: str, limit_s: float = 60.0) -> OwnRun:
    """Run a program of blocks on the stage's robot, as a page does, and return the run."""
    robot = tidied(stage).robot(who=PUPIL)
    request = BlockRun(RunBlocks(1, ("sim",), program), robot)

    def perform() -> None:
        with contextlib.suppress(BeatrixError):
            request.perform(lambda _: None)
        request.over.set()

    with OwnRun(robot.client, ROBOT, limit_s) as run:
        thread = threads.start(perform, "blocks")
        while not request.over.wait(0.1):
            if not run.look():
                request.end(WindowError(Reason.STOPPED, "result.stopped"))
    thread.join(10.0)
    robot.client.close()
    return run


def judged(stage: Stage, program: str, lesson: Lesson) -> Verdict:
    """Return the verdict of a run; skip the test if this computer is too busy twice."""
    verdicts = (observed(stage, program).verdict(lesson) for _ in range(BUSY_TRIES))
    found = next((one for one in verdicts if one.result is not Result.NOT_MEASURABLE), None)
    return found or pytest.skip("this computer is too busy")


@pytest.mark.parametrize(("lesson", "wrong"), cases())
def test_a_run_is_judged_as_meant(lesson: BlockLesson, wrong: Wrong | None, stage: Stage) -> None:
    program = wrong.program(solution(lesson)) if wrong else solution(lesson)
    verdict = judged(stage, program, lesson)
    assert verdict.figure == (wrong.expects if wrong else ""), verdict


def test_a_wrong_program_gets_the_sentences_of_python_and_is_counted_and_reported_for_its_seat(
    stage: Stage, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reported: list[tuple[object, str, LessonState]] = []
    monkeypatch.setattr(lesson_reports, "_publish", lambda *what: reported.append(what))
    run, python = observed(stage, NODS_ONCE), Lesson(LIBRARY / "01-hello", "de")
    lesson = BlockLesson(LIBRARY / "01-hello", "de")
    found, same = run.verdict(lesson), run.verdict(python)
    if found.result is Result.NOT_MEASURABLE:
        pytest.skip(found.means)
    assert (found.figure, found.asked, found.found) == (same.figure, same.asked, same.found)
    assert found.figure == "nods"
    assert found.means == "Nach unten und wieder nach oben sind zwei Schwünge: Nicke zweimal, und weit genug."
    seat = SimpleNamespace(account=1, who="p01")
    verdicts = (found, Verdict(Result.PASSED), Verdict(Result.NOT_MEASURABLE))
    record = [own_run.keep(lesson, one, NODS_ONCE, tmp_path / "p01", seat) for one in verdicts][-1]  # type: ignore[arg-type]
    assert (record.tries, record.figure, len(record.passed)) == (2, "", 1)
    assert [record.next_hint(lesson) for _ in range(4)] == [1, 2, 3, 1]
    assert [settings for settings, _, _ in reported] == [seat] * 3
    assert [state.figure for _, _, state in reported] == ["nods", "", "not-measured"]


def test_what_cannot_be_judged_is_no_try(stage: Stage, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(own_run, "FIRST_S", 0.1)
    hello, client = BlockLesson(LIBRARY / "01-hello"), stage.robot(who=PUPIL).client
    with OwnRun(client, "nobody", 1.0) as run:
        pass
    assert run.verdict(hello).result is Result.NOT_MEASURABLE
    verdict = run.verdict(Lesson(LIBRARY / "03-arms"))
    assert verdict.result is Result.NOT_MEASURABLE
    assert "does not suit blocks" in verdict.means


def test_a_program_without_end_fails_at_the_limit(stage: Stage) -> None:
    endless = NODS_ONCE.replace('"type": "home"', '"type": "forever"')
    verdict = observed(stage, endless, 1.5).verdict(BlockLesson(LIBRARY / "01-hello"))
    assert verdict.figure == "ends"
    assert "forever" in verdict.means


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("name", [lesson.name for lesson in LESSONS])
def test_texts_are_complete_and_speak_of_blocks(name: str, language: str) -> None:
    lesson = BlockLesson(LIBRARY / name, language)
    python = (LIBRARY / name / "start.py").is_file()
    assert lesson.language == language
    assert len(lesson.hints) == 3
    assert all(30 <= len(hint.split()) <= 90 for hint in lesson.hints), [len(h.split()) for h in lesson.hints]
    figures = FIGURE.findall((lesson.folder / "check.py").read_text(encoding="utf-8"))
    said = [*lesson.hints, lesson.page.read_text(encoding="utf-8")]
    for figure in {*figures, "nothing", "all_refused", "tiny", "ends"} - ({"scene"} if python else set()):
        assert lesson.figure(figure).hint in range(4)
        said.append(lesson.figure(figure).means)
    assert not re.search(r"robot\.\w|Python|look\(|`|program calls", "".join(said))


@pytest.mark.parametrize("language", ["en", "de"])
def test_the_page_has_titles_and_text_without_marks(language: str) -> None:
    pages = lesson_pages(language)
    assert [page.name for page in pages] == ["01-hello", "b2-steps", "b6-edge", "b8-rhythm", "12-character"]
    for page in pages:
        assert all((page.title, page.goal))
        assert {one.kind for one in page.text} == {"heading", "text", "item"}
        assert not [one for one in page.text if re.search(r"[*`#<>]", one.text)]
    assert lesson_pages("en")[0].title != lesson_pages("de")[0].title


def test_paragraphs_join_lines_and_have_no_marks() -> None:
    text = "# Title\n\nOne\n*two*.\n\n## Head\n* a\n  b\n2. c `d`\n\nEnd"
    assert [(one.kind, one.text) for one in paragraphs(text)] == [
        ("text", "One two."),
        ("heading", "Head"),
        ("item", "a b"),
        ("item", "c d"),
        ("text", "End"),
    ]


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_a_solution_uses_blocks_of_its_lesson_only(lesson: BlockLesson) -> None:
    used = {block.kind for block in inside(read(solution(lesson)).blocks)}
    assert used | {"start"} <= {*lesson.about.blocks} <= {"start", *STATEMENTS, *VALUES}
    right = solution(lesson)
    programs = [wrong.program(right) for wrong in wrong_programs(f"blocks/{lesson.name}").values()]
    assert 3 <= len({*programs} - {right}) == len(programs)


def test_verbs_know_lessons_in_python_only_and_the_router_all() -> None:
    assert [one.number for one in lessons()] == [*range(1, 13)]
    assert {one.name for one in LESSONS} <= {*names()}
