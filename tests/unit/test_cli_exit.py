"""Results of verbs: messages, JSON and exit codes."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import typer

from beatrix_zenoh import Interrupted, NoAnswer, Refused
from beatrix_zenoh.cli import app
from beatrix_zenoh.cli.verbs import VERBS
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.output import CODES
from beatrix_zenoh.shutdown import FAULT, process
from beatrix_zenoh.terminal.options import Json
from beatrix_zenoh.terminal.run import run_command

CLI = (sys.executable, "-m", "beatrix_zenoh.cli")


def run_failing_verb(error: BaseException, *words: str) -> int:
    """Run a verb that raises this error, and return its exit code."""

    def failing(as_json: Json = False) -> None:
        raise error

    return run_command(failing, "beatrix", words)


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (Refused(Reason.OUT_OF_REACH, "too far"), 1),
        (Refused(Reason.BAD_VALUE, "rejected by the robot"), 1),
        (WrongUsage(Reason.BAD_VALUE, "rejected locally"), 2),
        (Interrupted(Reason.STOPPED, "stopped"), 1),
        (NoAnswer(Reason.BOARD_LOST, "no board"), 1),
        (NoAnswer(Reason.NO_ROUTER), 3),
        (NoAnswer(Reason.TIMED_OUT), 4),
        (NoAnswer(Reason.NO_ANSWER), 5),
        (NoAnswer(Reason.NO_SUCH_ROBOT), 6),
        (NoAnswer(Reason.ACCOUNT_REFUSED), 7),
        (NoAnswer(Reason.ACCESS_DENIED), 8),
        (NoAnswer(Reason.NODE_LOST), 9),
        (NoAnswer(Reason.NODE_HANGS), 10),
        (typer.BadParameter("nonsense"), 2),
        (typer.Exit(4), 4),
        (KeyboardInterrupt(), 130),
    ],
)
def test_every_failure_has_its_exit_code(error: BaseException, code: int) -> None:
    assert run_failing_verb(error) == code


@pytest.mark.parametrize(
    ("page", "row"),
    [("reference/exit-codes.md", r"^\| (\d+) \| `(\w+)`"), ("how-to/no-answer.md", r"`(\w+)` \| (\d+) \|")],
)
def test_the_pages_list_the_exit_code_of_each_missing_answer(page: str, row: str) -> None:
    text = (Path(__file__).parents[2] / "docs" / page).read_text(encoding="utf-8")
    pairs = [sorted(found) for found in re.findall(row, text, re.MULTILINE)]
    assert {(int(code), reason) for code, reason in pairs} >= {
        (code, str(reason)) for reason, code in CODES.items()
    }


def test_a_failure_is_one_sentence_on_stderr_or_one_document_on_stdout(
    capsys: pytest.CaptureFixture[str],
) -> None:
    far = Refused(Reason.OUT_OF_REACH, "Too far.")
    run_failing_verb(far)
    assert capsys.readouterr() == ("", "Too far.\n")
    run_failing_verb(far, "--json")
    out, err = capsys.readouterr()
    assert json.loads(out) == {"result": False, "reason": "OUT_OF_REACH", "message": "Too far."}
    assert err == ""


@pytest.mark.parametrize(
    ("words", "wrong"),
    [
        (("look", "--yaw", "left"), "left"),
        (("look", "--nonsense"), "--nonsense"),
        (("look", "--on", "moon"), "moon"),
        (("move", "1", "2"), "long"),
        (("dance",), "dance"),
        (("play", "yes", "--lockstep"), "--on both"),
        (("look", "--name", "Bea 1"), "bea-1"),
        (("look", "--who", "Ana"), "'ana'"),
        (("look", "--name", "a/b"), "a-b"),
        (("ls", "--connect", "localhost"), "protocol/host:port"),
        (("stop", "--connect", "tcp/127.0.0.1:99999"), "protocol/host:port"),
        (("doctor", "--connect", "http/127.0.0.1:80"), "protocol is tcp"),
        (("sim", "--nonsense"), "--nonsense"),
        (("look", "20"), "(20)"),
        (("hw", "--nonsense"), "--nonsense"),
    ],
)
def test_wrong_usage_with_json_prints_one_json_document(
    words: tuple[str, ...], wrong: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert app.run([*words, "--json"]) == 2
    out, err = capsys.readouterr()
    document = json.loads(out)
    assert (document["result"], document["reason"], err) == (False, "BAD_VALUE", "")
    assert wrong.lower() in document["message"].lower()


@pytest.mark.parametrize("name", VERBS)
def test_every_verb_has_help_with_its_units(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert app.run([name, "--help"]) == 0
    text = capsys.readouterr().out
    assert text.startswith(f"Usage: beatrix {name} [OPTIONS]")
    assert not set(text) & set("│╭")
    if name in ("look", "move", "info", "echo", "top"):
        assert "egrees" in text


def test_help_lists_every_verb_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert app.run(["--help"]) == 0
    lines = capsys.readouterr().out.partition("Commands:")[2].strip().splitlines()
    assert [line.split()[0] for line in lines] == list(VERBS)
    assert not [line for line in lines if line.endswith("...")]


OUTPUTS = pytest.mark.parametrize("words", [("--help",), ("look", "--nonsense", "--json")])


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux has /dev/full")
@OUTPUTS
def test_a_full_disk_is_reported_in_one_line(words: tuple[str, ...]) -> None:
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        done = subprocess.run([*CLI, *words], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "No space left" in done.stderr


@OUTPUTS
def test_a_closed_pipe_ends_the_verb_without_a_message(words: tuple[str, ...]) -> None:
    end, pipe = os.pipe()
    os.close(end)
    with open(pipe, "wb") as closed:  # noqa: PTH123 - a file descriptor has no path
        done = subprocess.run([*CLI, *words], stdout=closed, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (141, "")


@pytest.mark.parametrize(
    "words",
    [
        ("record", "mine.rrd", "--seconds"),
        ("record", "mine.rrd", "--cameras"),
        ("compare", "--seconds"),
        ("hz", "--seconds"),
        ("sim", "--eyes-hz"),
        ("replay", "mine.csv", "--speed-factor"),
        ("replay", "mine.csv", "--on", "both", "--lead"),
        ("look", "--yaw"),
        ("play", "hello", "--on", "both", "--lead"),
    ],
)
def test_a_number_that_is_not_finite_is_wrong_usage_and_leaves_no_file(
    words: tuple[str, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert app.run([*words, "nan"]) == 2
    assert capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_an_unexpected_exception_ends_the_process_with_the_code_of_a_fault(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit) as end:
        process(lambda: 1 // 0)
    assert end.value.code == FAULT
    assert "ZeroDivisionError" in capsys.readouterr().err
