"""The drawing process and its handle."""

from __future__ import annotations

import pytest
import simplejpeg

from beatrix_zenoh.contract._generated.robot import ROBOT
from sim_node import gl
from sim_node import renderer as rendering
from sim_node.painter import SceneState
from sim_node.plant import Plant
from sim_node.renderer import HEIGHT, WIDTH, Renderer
from sim_node.target import HOME

NOW = SceneState(0, Plant().posture(), HOME)


def start_renderer() -> Renderer:
    backend = gl.backend()
    if backend is None:
        pytest.skip("no OpenGL on this machine")
    renderer = Renderer(ROBOT, backend)
    renderer.open()
    return renderer


def test_only_the_requested_views_are_drawn() -> None:
    renderer = start_renderer()
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


def test_a_late_picture_raises_timeout_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rendering, "PICTURE_S", 0.0)
    renderer = start_renderer()
    assert dict(renderer.draw(NOW, ["left"])), "the first picture may take longer"
    with pytest.raises(TimeoutError, match="hangs"):
        dict(renderer.draw(NOW, ["left"]))
    renderer.close()
