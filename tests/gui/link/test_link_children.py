"""The link of the window: its child processes (simulation, viewer, recorder), pictures and files."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest
from gui_links import Linked, look
from present import present
from robots import free_endpoint

from beatrix_zenoh.client import Presence
from beatrix_zenoh.processes import Child
from beatrix_zenoh.recording.verbs.files import read_recording
from gui.console.link.children import SIMULATION
from gui.console.state import actions
from gui.console.state.world import LinkPhase, RecordingProgress

READY_S = 60.0
"""Time limit (s) of a child process on a busy machine."""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Work in a folder of this test."""
    monkeypatch.chdir(tmp_path)


def kill(child: Child) -> None:
    """Kill a process, as a system without free memory does."""
    os.kill(child._process.pid, signal.SIGKILL)


def test_the_error_of_a_viewer_without_its_file_names_the_cause(linked: Linked, tmp_path: Path) -> None:
    linked.do(actions.ViewRecording(tmp_path / "none.rrd"))
    world = linked.until(lambda world: bool(world.child_trouble), "it has ended", READY_S)
    trouble = present(world.child_trouble)
    assert (trouble.key, "none.rrd" in trouble.detail) == ("trouble.viewer", True)


# -- a simulation of the window -------------------------------------------------------------------


def test_a_simulation_and_a_router_are_started_and_end_with_the_window() -> None:
    with Linked(free_endpoint()) as linked:
        linked.until(lambda world: world.phase is LinkPhase.NO_ROUTER, "there is no router")
        linked.do(actions.StartSimulation())
        assert linked.world.starting
        world = linked.until(
            lambda world: not world.starting and linked.link._children.runs(SIMULATION), "it runs", READY_S
        )
        assert world.child_trouble is None
        linked.online("sim")
        linked.do(actions.Send(1, look(5), ("sim",)))
        assert linked.end_of(1, "sim").accepted
        kill(linked.link._children._nodes[SIMULATION])
        world = linked.until(lambda _: not linked.link._children.runs(SIMULATION), "it was killed")
        trouble = present(world.child_trouble)
        assert (trouble.key, trouble.code) == ("trouble.simulation", "SIGKILL")
        linked.until(lambda world: world.sim.presence is Presence.ABSENT, "it is absent")
        linked.do(actions.StartSimulation())
        assert linked.world.child_trouble is None
        linked.until(lambda _: linked.link._children.runs(SIMULATION), "it runs again", READY_S)
        linked.online("sim")


def test_a_simulation_for_a_router_on_another_computer_is_refused() -> None:
    with Linked("tcp/203.0.113.1:7447") as linked:
        linked.do(actions.StartSimulation())
        world = linked.until(lambda world: not world.starting, "it is refused", READY_S)
        trouble = present(world.child_trouble)
        assert (trouble.key, "another computer" in trouble.detail) == ("trouble.elsewhere", True)
        assert not linked.link._children.runs(SIMULATION)


# -- recordings -----------------------------------------------------------------------------------


def begun(linked: Linked) -> RecordingProgress:
    """Begin a recording; return its progress after half a second."""
    linked.do(actions.BeginRecording())
    world = linked.until(
        lambda world: world.recording is not None and world.recording.seconds > 0.5, "it records", READY_S
    )
    return present(world.recording)


def ended(linked: Linked) -> RecordingProgress:
    """Wait for the end of the recording; return its progress."""
    world = linked.until(
        lambda world: world.recording is not None and not world.recording.running, "it has ended"
    )
    return present(world.recording)


def test_a_recording_can_be_read(linked: Linked, tmp_path: Path) -> None:
    linked.do(actions.EndRecording())  # no recording runs, so this does nothing
    assert linked.world.recording is None
    first = begun(linked)
    assert (first.running, first.trouble) == (True, None)
    assert first.file.parent == tmp_path / "recordings"
    linked.do(actions.Send(1, look(5), ("sim",)))
    assert linked.end_of(1, "sim").accepted
    linked.do(actions.EndRecording())
    last = ended(linked)
    assert last.trouble is None
    assert last.seconds >= first.seconds
    assert ("bea", "sim") in read_recording(first.file).robots


def test_the_loss_of_the_recorder_is_reported(linked: Linked) -> None:
    begun(linked)
    kill(linked.link._recordings._processes.children[-1])
    trouble = present(ended(linked).trouble)
    assert (trouble.key, trouble.code) == ("trouble.recorder", "SIGKILL")


def test_a_file_is_written_or_the_failure_is_reported(linked: Linked, tmp_path: Path) -> None:
    linked.do(actions.WriteFile(1, tmp_path / "a.csv", "t_s,°\n"))
    assert linked.end_of(1).accepted
    assert (tmp_path / "a.csv").read_text(encoding="utf-8") == "t_s,°\n"
    linked.do(actions.WriteFile(2, tmp_path / "none" / "a.csv", ""))
    end = linked.end_of(2)
    assert (end.accepted, end.key) == (False, "result.no_write")
