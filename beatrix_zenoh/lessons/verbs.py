"""`beatrix lesson`: start a lesson, check the program, get a hint."""

from __future__ import annotations

import contextlib
import itertools
import shutil
import sys
from collections.abc import Iterator
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from beatrix_zenoh.contract.errors import BeatrixError, bad_value
from beatrix_zenoh.files import from_here
from beatrix_zenoh.lesson_files import Lesson, find, lessons
from beatrix_zenoh.lessons import program as programs
from beatrix_zenoh.lessons import progress
from beatrix_zenoh.lessons.class_verbs import Number, report, turn
from beatrix_zenoh.lessons.progress import Record, Workspace
from beatrix_zenoh.output import columns, note, print_failure, print_json, say
from beatrix_zenoh.terminal.options import Json

if TYPE_CHECKING:
    from beatrix_zenoh.lessons.checking import Verdict
    from beatrix_zenoh.lessons.stage import Stages

START = {
    "en": ("Lesson {number}: {title} ({minutes} minutes)", "folder", "read", "change", "check"),
    "de": ("Lektion {number}: {title} ({minutes} Minuten)", "Ordner", "lesen", "ändern", "prüfen"),
}
"""What `start` prints: the head, and the labels of the lines below it."""
CHECK = {
    "en": "# Save the notebook, then run this cell.\n!beatrix lesson check {number}",
    "de": "# Sichere das Notebook, dann starte diese Zelle.\n!beatrix lesson check {number}",
}
NEXT = {"en": "The next lesson", "de": "Die nächste Lektion"}
LESSON = "`beatrix lesson"
CLEAR = "\x1b[2J\x1b[H"
"""Clears the screen of a terminal, so that only the newest verdict is on it."""
lesson = typer.Typer(
    name="lesson",
    help="Learn with the robot. Begin with `beatrix lesson list`.",
    no_args_is_help=True,
)
lesson.command()(turn)
lesson.command()(report)


class LessonLanguage(StrEnum):
    """Languages of lessons."""

    ENGLISH = "en"
    GERMAN = "de"


LatestNumber = Annotated[
    int | None,
    typer.Argument(
        metavar="[N]", min=1, help="Number of the lesson; default: the one whose program was saved last."
    ),
]


def _workspace() -> Workspace:
    return progress.workspace(Path.cwd())


def _find(number: int, workspace: Workspace) -> Lesson:
    return find(number, workspace.progress.language)


@contextlib.contextmanager
def _writing(folder: Path) -> Iterator[None]:
    """Raise Refused (BAD_VALUE) if a file of this folder cannot be written."""
    try:
        yield
    except OSError as error:
        raise bad_value(
            f"{from_here(folder)} cannot be written: {error.strerror}. Work in a folder of your own, for example in your home folder.",
        ) from error


@lesson.command("list")
def list_lessons(as_json: Json = False) -> None:
    """List the lessons: S is for schools (from 14 years), U for universities."""
    workspace = _workspace()
    found = lessons(workspace.progress.language)
    rows = [
        {
            "number": one.number,
            "name": one.name,
            "title": one.title,
            "minutes": one.about.minutes,
            "level": one.about.level,
            "needs": one.about.needs,
            "state": _state(workspace.progress.lessons.get(one.name)),
        }
        for one in found
    ]
    if as_json:
        print_json({"result": True, "lessons": rows})
        return
    shown = ("number", "title", "minutes", "level", "needs", "state")
    texts = [row | {"needs": ", ".join(one.about.needs) or "-"} for row, one in zip(rows, found, strict=True)]
    say(columns(("lesson", *shown[1:]), [tuple(str(row[name]) for name in shown) for row in texts]))
    note(f"Levels: S schools (from 14 years), U universities. Start one: {LESSON} start {found[0].number}`.")


def _state(record: Record | None) -> str:
    if record is None:
        return "-"
    if record.passed:
        return "passed"
    return f"tried {record.tries} x" if record.tries else "started"


@lesson.command()
def start(
    number: Number,
    notebook: Annotated[
        bool, typer.Option("--notebook", help="Write a Jupyter notebook instead of a Python file.")
    ] = False,
    language: Annotated[
        LessonLanguage | None,
        typer.Option(help="Language of pages, hints and checks from now on, where a lesson has it."),
    ] = None,
) -> None:
    """Copy the page and the program of a lesson to the folder `lessons`. Existing files are never overwritten."""
    workspace = _workspace()
    if language is not None:
        workspace.progress.language = language.value
    found = _find(number, workspace)
    folder = workspace.folder / found.name
    suffix = ".ipynb" if notebook else ".py"
    program = folder / f"start{suffix}"
    if program.exists():
        raise bad_value(
            f"{from_here(program)} exists and is not overwritten. {LESSON} check {number}` checks it; "
            f"{LESSON} reset {number}` gives you a fresh one, and keeps this one.",
        )
    with _writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(found.page, folder / "lesson.md")
        for extra in sorted((found.folder / "files").glob("*")):
            if not (folder / extra.name).exists():
                shutil.copyfile(extra, folder / extra.name)
        _write_program(found, program)
    workspace.record(found.name).version = found.about.version
    workspace.save()
    if found.language != workspace.progress.language:
        note(f"Lesson {number} is not translated: its page, hints and checks are English.")
    head, *labels = START[found.language]
    say(head.format(number=number, title=found.title, minutes=found.about.minutes))
    say(f"  {found.goal}")
    values = (folder, from_here(folder / "lesson.md"), from_here(program), f"beatrix lesson watch {number}")
    for label, value in zip(labels, values, strict=True):
        say(f"  {label:<8} {value}")


def _write_program(found: Lesson, path: Path) -> None:
    text = (found.folder / "start.py").read_text(encoding="utf-8")
    if path.suffix == ".ipynb":
        page = found.page.read_text(encoding="utf-8")
        text = programs.notebook(text, page, CHECK[found.language].format(number=found.number))
    path.write_text(text, encoding="utf-8")


@lesson.command()
def check(
    number: LatestNumber = None,
    keep: Annotated[
        bool, typer.Option("--keep", help="Record the simulated robot to check.rrd in the lesson's folder.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Check your program with simulations of its own. No robot is moved.

    Exit codes: 0 passed, 1 not yet, 4 this computer was too busy to measure.
    """
    from beatrix_zenoh.lessons.stage import open_stage
    from beatrix_zenoh.shutdown import signals_interrupt

    found, path = _checkable(number)
    recording = path.with_name("check.rrd")
    note(f"Checking {from_here(path)} …")
    with signals_interrupt():
        verdict = _judge(found, path, open_stage, as_json, recording if keep else None)
    if keep and not recording.exists():
        note("This check used no simulated robot that runs in real time: there is nothing to record.")
    if verdict.result.value:
        raise typer.Exit(verdict.result.value)


@lesson.command("watch")
def watch_program(number: LatestNumber = None, as_json: Json = False) -> None:
    """Check your program now and at each save, until it passes or you press Ctrl-C.

    It is faster than `check`: the simulation stays up. With --json each line is a document.
    """
    from beatrix_zenoh.lessons.checking import Result, Verdict
    from beatrix_zenoh.lessons.watching import watch

    found, _ = _checkable(number)
    workspace = _workspace()

    def check_now(path: Path, stages: Stages) -> Verdict:
        if as_json:
            print_json({"lesson": found.name, "outcome": "checks"})
        else:
            if sys.stdout.isatty():
                print(CLEAR, end="")
            note(f"Checking {from_here(path)} …")
        try:
            verdict = _judge(found, path, stages, as_json)
        except BeatrixError as error:  # for example a file that is no text: the next save may cure it
            verdict = Verdict(Result.NOT_MEASURABLE)
            print_failure(error.reason, error.message) if as_json else say(error.message)
        if not as_json and verdict.result.value:
            note(f"Save {from_here(path)} to check it again; Ctrl-C ends.")
        return verdict

    passed = watch(lambda: workspace.programs(found.name), check_now)
    number = min((one.number for one in lessons() if one.number > found.number), default=None)
    if passed and number and not as_json:
        say(f"{NEXT[found.language]}: beatrix lesson start {number}")


def _checkable(number: int | None) -> tuple[Lesson, Path]:
    """Return lesson and program as `_program`; raises Refused to the teacher, whose account the program could use."""
    from beatrix_zenoh.lessons.sandbox import refuse_teacher
    from beatrix_zenoh.settings import resolve_valid

    refuse_teacher(resolve_valid()[0].account)
    return _program(number, _workspace())


def _judge(found: Lesson, path: Path, stages: Stages, as_json: bool, keep: Path | None = None) -> Verdict:
    """Check a program, show the verdict, and keep and report it."""
    from beatrix_zenoh.lessons import checking, own_run

    program = programs.read(path)
    verdict = checking.check(found, program, keep=keep, tell=note, stages=stages)
    record = own_run.keep(found, verdict, program.text, path.parents[1])
    picture = checking.keep_picture(verdict, path.with_name(f"lesson-{found.number}.svg"))
    if as_json:
        print_json(checking.document(found, verdict, record, picture))
    else:
        checking.show(found, verdict, record, picture and from_here(picture))
    return verdict


def _program(number: int | None, workspace: Workspace) -> tuple[Lesson, Path]:
    """Return a lesson that was started, and the pupil's program; raises Refused if there is none."""
    if number is not None:
        found = _find(number, workspace)
        paths = workspace.programs(found.name)
        if not paths:
            raise bad_value(
                f"{from_here(workspace.folder / found.name)} has no program. Start the lesson: {LESSON} start {number}`.",
            )
        return found, paths[0]
    started = [
        (path, one) for one in lessons(workspace.progress.language) for path in workspace.programs(one.name)
    ]
    if not started:
        raise bad_value(
            f"{workspace.folder} has no lesson yet. If yours are in another folder, go there first. Start one: {LESSON} start 1`. {LESSON} list` shows all.",
        )
    path, found = max(started, key=lambda pair: pair[0].stat().st_mtime)
    return found, path


@lesson.command()
def hint(number: LatestNumber = None) -> None:
    """Print a hint: the one that helps with what the last check has found, then the others."""
    from beatrix_zenoh.client import lesson_reports
    from beatrix_zenoh.lessons.checking import LABELS, filled

    workspace = _workspace()
    found, _ = _program(number, workspace)
    record = workspace.record(found.name)
    known = len(record.hints)
    chosen = record.next_hint(found)
    if len(record.hints) > known:
        workspace.save()
        lesson_reports.report(found.name, record.state())
    text = f"{LABELS[found.language][4]} {chosen}/{len(found.hints)}: {found.hints[chosen - 1]}"
    say(filled(text))


@lesson.command()
def reset(number: Number) -> None:
    """Write a fresh start file; the old one becomes start-1.py, start-2.py and so on."""
    workspace = _workspace()
    found, path = _program(number, workspace)
    places = (path.with_name(f"{path.stem}-{i}{path.suffix}") for i in itertools.count(1))
    kept = next(place for place in places if not place.exists())
    with _writing(path.parent):
        path.rename(kept)
        _write_program(found, path)
    say(f"{from_here(path)} is as at the beginning. The old one is {from_here(kept)}.")


@lesson.command()
def solution(
    number: Number,
    show: Annotated[bool, typer.Option("--show", help="Also before your program has passed.")] = False,
) -> None:
    """Print a solution, once your program has passed."""
    workspace = _workspace()
    found = _find(number, workspace)
    if not workspace.record(found.name).passed and not show:
        raise bad_value(
            f"Your program has not passed yet. {LESSON} hint {number}` helps; --show prints the solution anyway.",
        )
    say((found.folder / "solution.py").read_text(encoding="utf-8"))
    note(f"The page for teachers: {found.teacher_page}")
