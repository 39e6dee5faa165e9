"""Where a pupil's program runs: what it can read, and what it leaves behind when its check has ended."""

from __future__ import annotations

import socket
import sys
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from pathlib import Path
from typing import NoReturn

import numpy as np
import pytest
from robots import EVENT_S, PATIENCE_S, until

from beatrix_zenoh import account
from beatrix_zenoh.contract import tracebacks
from beatrix_zenoh.lesson_files import find
from beatrix_zenoh.lessons import checking, program, sandbox
from beatrix_zenoh.lessons.attempt import Attempt, Unmet
from beatrix_zenoh.lessons.guarded import Run
from beatrix_zenoh.lessons.phrases import said
from beatrix_zenoh.lessons.sandbox import Sandbox
from beatrix_zenoh.lessons.stage import PAUSE_S, hidden_s
from sim_node.body import STALL_S

READS = """
import os
from pathlib import Path
from beatrix_zenoh.account import joined
def found(path):
    try:
        text = Path(path).read_text()
    except OSError:
        text = ""
    return [joined().exists(), os.environ.get("BEATRIX_ACCOUNT"), os.environ.get("SECRET"), Path.home().name, text]
"""
FORKS = """
import os, socket, time
def leave(port):
    there, begun = os.pipe()
    for _ in range(20):
        if os.fork() == 0:
            os.setsid()
            if os.fork() == 0:
                connection = socket.create_connection(("127.0.0.1", port))
                os.write(begun, b".")
                time.sleep(600)
            os._exit(0)
        os.read(there, 1)
leave(int(os.environ["PORT"]))
os._exit(0)
"""
FORKED = 20

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no fork and no groups")


@pytest.fixture(params=[False, True], ids=["without bubblewrap", "bubblewrap"])
def fence(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    """Whether programs run behind bubblewrap."""
    if request.param and not sandbox.bubblewrap_works():
        pytest.skip("bubblewrap is not installed, or must not make namespaces here")
    monkeypatch.setattr(sandbox, "bubblewrap_works", lambda: request.param)
    return bool(request.param)


def written(folder: Path, text: str) -> program.Program:
    own = folder / "own"
    own.mkdir(exist_ok=True)
    path = own / "start.py"
    path.write_text(text)
    return program.read(path)


@contextmanager
def running(folder: Path, text: str, **environment: str) -> Iterator[Run]:
    """Run a program as an observed check does, without a robot."""
    made, temporary = written(folder, text), folder / "temporary"
    temporary.mkdir()
    with closing(Run(Sandbox(made, temporary), environment)) as run:
        yield run


def failure(folder: Path, text: str, **environment: str) -> Unmet:
    """Return what is said about a program that ends by itself."""
    with running(folder, text, **environment) as run:
        until(lambda: not run.running, "its end")
        with pytest.raises(Unmet) as unmet:
            run.check()
    return unmet.value


def test_a_program_has_no_account_and_behind_bubblewrap_sees_no_file_of_the_user(
    fence: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    private = account.joined()
    private.parent.mkdir(parents=True, exist_ok=True)
    private.write_text("private")
    monkeypatch.setenv("BEATRIX_ACCOUNT", str(private))
    monkeypatch.setenv("SECRET", "1")
    try:
        with Attempt(written(tmp_path, READS), limit_s=5) as tried:
            found = tried.value("found", str(private))
    finally:
        private.unlink()
    assert found == [False, "", None, "home", "" if fence else "private"]


def test_processes_that_a_program_leaves_in_other_sessions_end_with_the_check(
    fence: bool, tmp_path: Path
) -> None:
    with ExitStack() as open_until_end, socket.create_server(("127.0.0.1", 0), backlog=FORKED) as server:
        server.settimeout(EVENT_S)
        with running(tmp_path, FORKS, PORT=str(server.getsockname()[1])):
            left = [open_until_end.enter_context(server.accept()[0]) for _ in range(FORKED)]
        for connection in left:
            connection.settimeout(PATIENCE_S)
            assert connection.recv(1) == b"", "its process has ended"


NO_CORE = "import resource\nresource.setrlimit(resource.RLIMIT_CORE, (0, 0))\n"
"""Lines of a program that crashes on purpose: `tools/crash.py` would report its core file."""


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("import os\nos._exit(3)", "exit code 3"),
        (f"{NO_CORE}import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)", "the signal SIGSEGV"),
        ("import os\nos.kill(os.getppid(), 9)\nwhile True:\n    pass", "the signal SIGKILL"),
        ("1 / 0", "ZeroDivisionError"),
    ],
    ids=["ends Python", "crash", "kills its guard", "error"],
)
def test_the_end_of_a_program_is_told(fence: bool, tmp_path: Path, text: str, error: str) -> None:
    assert error in str(said(failure(tmp_path, text).values["error"]))


def test_a_program_that_is_ended_may_bring_its_robot_to_rest_first(fence: bool, tmp_path: Path) -> None:
    text = "try:\n    sum(range(10**7))\n    print('there')\n    while True:\n        pass\nexcept KeyboardInterrupt:\n    print('rests')\n"
    with running(tmp_path, text) as run:
        until(lambda: run.output == ["there"], "it runs")
    assert run.output == ["there", "rests"]
    assert run.cores > 0


def test_a_syntax_error_is_found_before_anything_is_started(tmp_path: Path) -> None:
    def none(*_: object) -> NoReturn:
        raise AssertionError

    verdict = checking.check(find(1), written(tmp_path, "x = 1\nif x\n    pass\n"), stages=none)
    assert (verdict.figure, verdict.found) == ("runs", "SyntaxError: expected ':' (line 2)")


@pytest.mark.parametrize(
    ("t", "seq", "commanded", "hidden"),
    [
        ([0, 0.02, 0.04], [7, 8, 9], [0, 0.6, 1.2], 0.02),
        ([0, 0.02, 0.22], [7, 8, 9], [0, 0.6, 6.0], 0.2),  # it was busy, and made the steps later
        ([0, 0.02, 2.02], [7, 8, 9], [0, 0.6, 1.2], 0.02),  # it stood still
        ([0, 0.02, 2.02], [7, 8, 9], [0, 0.6, 6.6], 0.02),  # and then was late by 0.2 s
        ([0, 0.02, 2.02], [7, 8, 20], [0, 0.6, 1.2], 2.0),  # positions were lost on the way
        ([0, 0.02, 2.02], [7, 8, 9], [0, 0.6, 30.0], 2.0),  # it moved unseen
    ],
)
def test_a_pause_of_the_simulation_hides_no_motion(
    t: list[float], seq: list[int], commanded: list[float], hidden: float
) -> None:
    arms = np.column_stack([commanded] * 3)
    assert hidden_s(np.array(t), np.array(seq), arms) == pytest.approx(hidden)
    assert PAUSE_S == STALL_S


DATA = {tracebacks.VARIABLE: tracebacks.DATA}
ABSENT = """
from beatrix_zenoh import NoAnswer
from beatrix_zenoh.contract._generated.messages import Detail, Reason
raise NoAnswer(Reason.NO_ANSWER, detail=Detail(field='ada (sim)', known=['bea1 (sim)']))
"""
LEANS = """
from beatrix_zenoh import Refused
from beatrix_zenoh.contract._generated.messages import Detail, Limit, Reason
def lean():
    raise Refused(Reason.OUT_OF_REACH, detail=Detail(limit=Limit.TILT, value=0.7, high=0.6, unit="rad", at_goal=True))
if __name__ == "__main__":
    lean()
"""


def test_a_program_for_another_robot_is_told_to_name_none(tmp_path: Path) -> None:
    assert failure(tmp_path, ABSENT, **DATA).figure == "other_robot"


def test_a_refusal_reaches_a_german_check_as_data(tmp_path: Path) -> None:
    of_program = failure(tmp_path, LEANS, **DATA)
    with Attempt(written(tmp_path, LEANS), limit_s=5) as tried, pytest.raises(Unmet) as called:
        tried.value("lean")
    german_text = "Refused: Der Kopf stünde 40,1° schräg; höchstens 34,3° sind erlaubt."
    german = find(1, "de")
    assert checking.verdict(german, of_program).found == f"{german_text} (Zeile 5)"
    assert checking.verdict(german, called.value).found == f"{german_text} in lean() (Zeile 5)"
