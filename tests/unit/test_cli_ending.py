"""How verbs end: sentences, JSON and exit codes."""

from __future__ import annotations

import json

import pytest
import typer

from beatrix_zenoh import BeatrixError, Interrupted, NoAnswer, Refused
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.cli import app
from beatrix_zenoh.cli.table import columns
from beatrix_zenoh.cli.verb import verb


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (Refused(Reason.OUT_OF_REACH, "too far"), 1),
        (Interrupted(Reason.STOPPED, "stopped"), 1),
        (NoAnswer(Reason.BOARD_LOST, "no board"), 1),
        (NoAnswer(Reason.NO_ANSWER, "nobody"), 3),
        (NoAnswer(Reason.NO_ROUTER, "no router"), 3),
        (NoAnswer(Reason.TIMED_OUT, "too late"), 4),
        (KeyboardInterrupt(), 130),
    ],
)
def test_every_failure_has_its_exit_code(error: BaseException, code: int) -> None:
    @verb
    def failing() -> None:
        raise error

    with pytest.raises(typer.Exit) as end:
        failing()
    assert end.value.exit_code == code


def test_a_failure_is_one_sentence_on_stderr(capsys: pytest.CaptureFixture[str]) -> None:
    @verb
    def failing() -> None:
        raise Refused(Reason.OUT_OF_REACH, "Too far; 35 degrees are allowed.")

    with pytest.raises(typer.Exit):
        failing()
    assert capsys.readouterr() == ("", "Too far; 35 degrees are allowed.\n")


def test_a_failure_as_json_is_one_document_on_stdout(capsys: pytest.CaptureFixture[str]) -> None:
    @verb
    def failing(*, as_json: bool) -> None:
        raise Refused(Reason.OUT_OF_REACH, f"Too far: {as_json}.")

    with pytest.raises(typer.Exit):
        failing(as_json=True)
    out, err = capsys.readouterr()
    assert json.loads(out) == {"result": False, "reason": "OUT_OF_REACH", "message": "Too far: True."}
    assert err == ""


def test_a_fault_of_ours_is_not_hidden() -> None:
    @verb
    def broken() -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        broken()


@pytest.mark.parametrize("name", [name for name in app.VERBS if name not in app.PROCESSES])
def test_every_verb_explains_itself_and_its_units(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        app.main([name, "--help"])
    assert end.value.code == 0
    text = capsys.readouterr().out
    assert "Usage: beatrix" in text
    if name in ("look", "move", "info", "echo", "top"):
        assert "egrees" in text


def test_help_names_every_verb_in_a_line_that_is_not_cut(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        app.main(["--help"])
    lines = capsys.readouterr().out.partition("Commands:")[2].strip().splitlines()
    assert [line.split()[0] for line in lines] == list(app.VERBS)
    assert not [line for line in lines if line.endswith("...")]


def test_missing_command_line_extra_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_typer(_verbs: object) -> typer.Typer:
        raise ModuleNotFoundError("No module named 'typer'", name="typer")

    monkeypatch.setattr(app, "build", no_typer)
    with pytest.raises(SystemExit, match=r'pip install "\.\[cli\]"'):
        app.main(["ls"])


def test_table_aligns_numbers_to_the_right_and_words_to_the_left() -> None:
    assert columns(("robot", "hz"), [("bea", "50.0"), ("b", "-")]) == "robot    hz\nbea    50.0\nb         -"


def test_errors_are_of_one_family() -> None:
    assert issubclass(NoAnswer, BeatrixError)
