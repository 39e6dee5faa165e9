"""The drawing process and its handle."""

from __future__ import annotations

import subprocess
import threading

import numpy as np
import pytest
import simplejpeg

from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.contract.errors import Refused
from sim_node import piped_process
from sim_node import renderer as rendering
from sim_node.painter import SceneState
from sim_node.plant import Plant
from sim_node.renderer import HEIGHT, WIDTH, Renderer
from sim_node.target import HOME
from sim_node.viewer import Viewer

NOW = SceneState(0, Plant().posture(), HOME)


def start_renderer(source: str) -> Renderer:
    renderer = Renderer(ROBOT, source)
    renderer.open()
    return renderer


def test_only_the_requested_views_are_drawn() -> None:
    renderer = start_renderer("rays")
    both = dict(renderer.draw(NOW, ["left", "right"]))
    assert list(both) == ["left", "right"]
    assert both["left"] != both["right"]
    assert [eye for eye, _ in renderer.draw(NOW, ["right"])] == ["right"]
    assert simplejpeg.decode_jpeg(both["left"]).shape == (HEIGHT, WIDTH, 3)
    again = dict(renderer.draw(NOW, ["left"]))
    assert again["left"] == both["left"]
    renderer.close()
    renderer.close()
    with pytest.raises(OSError, match="closed"):
        list(renderer.draw(NOW, ["left"]))


def test_an_unknown_source_is_an_error_at_the_start() -> None:
    renderer = Renderer(ROBOT, "nonsense")
    with pytest.raises(OSError, match="nonsense cannot draw on this computer"):
        renderer.open()


def assert_closing_interrupts_drawing(renderer: Renderer) -> None:
    ended = threading.Event()

    def draw() -> None:
        try:
            while True:
                dict(renderer.draw(NOW, ["left", "right"]))
        except OSError:
            ended.set()

    drawer = threading.Thread(target=draw)
    drawer.start()
    renderer.close()
    assert ended.wait(5.0)
    drawer.join()


def test_closing_interrupts_drawing() -> None:
    assert_closing_interrupts_drawing(start_renderer("rays"))


def test_closing_interrupts_drawing_in_a_process_that_cannot_be_killed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    renderer = start_renderer("rays")
    with monkeypatch.context() as stuck:
        stuck.setattr(subprocess.Popen, "kill", lambda _: None)
        stuck.setattr(piped_process, "ENDING_S", 0.1)
        assert_closing_interrupts_drawing(renderer)
    renderer.close()


def test_closing_interrupts_the_start() -> None:
    renderer = Renderer(ROBOT, "rays")
    closing = threading.Timer(0.1, renderer.close)
    closing.start()
    with pytest.raises(OSError, match="cannot draw"):
        renderer.open()
    closing.join()


def test_a_late_picture_raises_timeout_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rendering, "PICTURE_S", 0.0)
    renderer = start_renderer("rays")
    assert dict(renderer.draw(NOW, ["left"])), "the first picture may take longer"
    with pytest.raises(TimeoutError, match="hangs"):
        dict(renderer.draw(NOW, ["left"]))
    renderer.close()


def test_a_posture_of_nan_does_not_end_the_process() -> None:
    renderer = start_renderer("rays")
    broken = SceneState(0, np.full_like(NOW.posture, np.nan), HOME)
    dict(renderer.draw(broken, ["left"]))
    assert dict(renderer.draw(NOW, ["left"]))
    renderer.close()


def test_the_viewer_needs_a_display(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(Refused, match="no window can be opened"):
        Viewer(ROBOT)
