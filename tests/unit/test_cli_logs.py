"""What child processes wrote: how long it stays."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from stage import until

from beatrix_zenoh import NoAnswer, Refused
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.cli import logs, processes
from beatrix_zenoh.cli.processes import Fleet


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for temporary files of our own."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


@pytest.fixture
def dead() -> int:
    """The number of a process that has ended."""
    with subprocess.Popen([sys.executable, "-c", ""]) as process:
        process.wait()
    return process.pid


def left_by(process: int) -> Path:
    """A folder as a process leaves it that is killed."""
    folder = logs.make()
    (folder / logs.OWNER).write_text(str(process))
    (folder / "router.log").write_text("ready\n")
    return folder


def fails(fleet: Fleet) -> None:
    """A child that ends by itself."""
    fleet.start("router", "router", "--nonsense")
    fleet.wait_ready()


def misses_it(fleet: Fleet) -> None:
    """As a client does whose router is such a child."""
    router = fleet.start("router", "router", "--nonsense")
    until(lambda: router.code is not None, "the router ends", 10)
    raise NoAnswer(Reason.NO_ANSWER, "No router.")


def test_folder_goes_when_all_went_well(temporary: Path) -> None:
    with Fleet() as fleet:
        assert fleet.folder.parent == temporary
    assert not list(temporary.iterdir())


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError])
def test_folder_goes_when_no_child_is_to_blame(temporary: Path, error: type[BaseException]) -> None:
    with pytest.raises(error), Fleet():
        raise error
    assert not list(temporary.iterdir())


def test_folder_goes_if_all_that_a_failed_child_wrote_was_shown(temporary: Path) -> None:
    with pytest.raises(Refused, match="No such option: --nonsense"), Fleet() as fleet:
        fails(fleet)
    assert not list(temporary.iterdir())


def test_folder_stays_when_a_child_failed_and_wrote_more_than_is_shown(
    temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(processes, "LAST_WORDS", 1)
    with pytest.raises(Refused) as failure, Fleet() as fleet:
        fails(fleet)
    (folder,) = temporary.iterdir()
    assert f"All it wrote is in {folder / 'router.log'}." in failure.value.message
    assert "No such option: --nonsense" in failure.value.message
    logs.sweep()
    assert "Usage: beatrix router" in (folder / "router.log").read_text()


def test_child_that_has_ended_explains_what_failed_without_it() -> None:
    with pytest.raises(Refused, match=r"The router has ended \(exit code 2\)"), Fleet() as fleet:
        misses_it(fleet)


def test_folder_of_a_killed_run_is_swept_up_by_the_next(dead: int) -> None:
    killed, running = left_by(dead), left_by(os.getppid())
    with Fleet():
        assert not killed.exists()
        assert running.exists()


def test_what_is_not_certainly_ours_is_left_alone(temporary: Path, dead: int) -> None:
    elsewhere = left_by(dead).rename(temporary / "mine")
    (temporary / "beatrix-link").symlink_to(elsewhere)
    beginning = logs.make()
    (beginning / logs.OWNER).write_text("")
    somebodys = temporary / "beatrix-notes"
    somebodys.mkdir()
    logs.sweep()
    assert (elsewhere / "router.log").exists()
    assert beginning.exists()
    assert somebodys.exists()


def test_news_are_whole_lines_and_told_once() -> None:
    with Fleet() as fleet:
        child = fleet.start("teller", "--version")
        until(lambda: child.code is not None, "ended")
        fleet.news()
        with child.log.open("a") as log:
            log.write("one\ntw")
        assert fleet.news() == ["teller: one"]
        assert fleet.news() == []
        with child.log.open("a") as log:
            log.write("o\n")
        assert fleet.news() == ["teller: two"]
        child.log.unlink()
        assert fleet.news() == []
        assert child.lines() == []
