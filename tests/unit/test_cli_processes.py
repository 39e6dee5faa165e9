"""Child processes: their output, and the folder of its files."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest
from robots import free_endpoint, until

from beatrix_zenoh import NoAnswer, Refused, processes
from beatrix_zenoh.cli.serving import start_programs
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.processes import Role, Supervisor
from beatrix_zenoh.settings import Settings


@pytest.fixture(autouse=True)
def temporary_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for the temporary files of one test."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def start_failing_child(supervisor: Supervisor) -> None:
    """Start a child that ends at once, and wait for it to become ready."""
    supervisor.start("router", "router", "--nonsense")
    supervisor.wait_ready()


def query_failed_router(supervisor: Supervisor) -> None:
    """Raise the error of a client whose router has ended."""
    router = supervisor.start("router", "router", "--nonsense")
    until(lambda: router.code is not None, "the router ends", 10)
    raise NoAnswer(Reason.NO_ANSWER, "No router.")


def test_a_refused_child_is_reported_and_not_started_again() -> None:
    with Supervisor() as supervisor:
        supervisor.start("router", "router", "--listen", free_endpoint())
        refused = supervisor.start("window", "gui", "--nonsense", role=Role.WINDOW)
        until(lambda: refused.code is not None, "it ends", 10)
        (report,) = supervisor.tend()
        assert [child.title for child in supervisor.children] == ["router"]
    assert report.startswith("The window has ended (exit code 2); the robots continue to run. Its ")
    assert "No such option: --nonsense" in report
    assert report.endswith("beatrix gui --nonsense")


def test_a_start_fails_only_when_no_robot_is_left(capfd: pytest.CaptureFixture[str]) -> None:
    with Supervisor() as supervisor:
        simulation = supervisor.start("simulation", "sim", "--nonsense", role=Role.ROBOT)
        until(lambda: simulation.code is not None, "it ends", 10)
        supervisor.start("hardware", "hw", "--port", "virtual", role=Role.ROBOT)
        with pytest.raises(Refused, match="The hardware has ended"):
            supervisor.wait_ready()
    assert "The simulation has ended (exit code 2) and stays down." in capfd.readouterr().err


def test_a_slow_start_is_reported_and_awaited(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(processes, "READY_S", 0.1)
    with Supervisor() as supervisor:
        router = supervisor.start("router", "router", "--listen", free_endpoint())
        supervisor.wait_ready()
        assert router.ready
    assert "Still waiting for the router after 0 s; Ctrl-C ends all." in capfd.readouterr().err


def test_the_folder_is_kept_if_a_failed_child_wrote_more_than_the_error_shows(
    temporary_files: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(processes, "LAST_LINES", 1)
    with pytest.raises(Refused) as failure, Supervisor() as supervisor:
        start_failing_child(supervisor)
    (folder,) = temporary_files.iterdir()
    assert f"Its complete output is in {folder / 'router.log'}." in failure.value.message
    assert "No such option: --nonsense" in failure.value.message
    assert "Usage: beatrix router" in (folder / "router.log").read_text()


def test_the_error_of_an_ended_child_replaces_the_error_that_it_caused() -> None:
    with pytest.raises(Refused, match=r"The router has ended \(exit code 2\)"), Supervisor() as supervisor:
        query_failed_router(supervisor)


# -- the commands that `beatrix up` suggests, and the order in which its processes end -------------


def test_robots_end_before_the_window_and_the_router_ends_last(monkeypatch: pytest.MonkeyPatch) -> None:
    ended = []

    class FakeChild:
        """A child that is ready at once."""

        ready, code = True, None

        def __init__(
            self, title: str, _arguments: object, _log: object, role: Role, _environment: object, _robots: int
        ) -> None:
            self.title, self.role = title, role

        def end(self) -> None:
            ended.append(self.title)

    monkeypatch.setattr(processes, "Child", FakeChild)
    with Supervisor() as supervisor:
        supervisor.start("router")
        programs = dict.fromkeys(("gui", "sim", "hw"), ())
        start_programs(supervisor, Settings("bea", "tcp/127.0.0.1:1", "ana"), programs)
    assert ended == ["hardware", "simulation", "window", "router"]
