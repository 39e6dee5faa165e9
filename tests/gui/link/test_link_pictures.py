"""Pictures and levels of the window: cameras and microphones are on while they are wanted."""

from __future__ import annotations

from gui_links import Linked
from robots import Process, Stage, until, wait_status

from gui.console.state.actions import Watch

FIRST_S = 20.0
"""Longest wait (s) for the first picture, which starts rendering."""
LEFT = ("hw", "left")


def pictures(linked: Linked, more_than: int) -> None:
    """Wait for pictures of the left eye."""
    until(lambda: linked.pictures.count(LEFT) > more_than, "pictures come", FIRST_S)


def test_a_camera_streams_only_while_its_pictures_are_wanted(linked: Linked, stage: Stage) -> None:
    robot = stage.robot("bea", "hw")
    linked.do(Watch(cameras=frozenset({LEFT})))
    pictures(linked, 3)
    assert [camera.streaming for camera in robot.status().cameras] == [True, False]
    linked.do(Watch())
    wait_status(robot, lambda status: not status.cameras[0].streaming, "the camera stops")


def test_pictures_return_with_a_restarted_robot(stage: Stage) -> None:
    def born() -> Process:
        process = stage.hardware("mortal")
        pictures(linked, linked.pictures.count(LEFT) + 2)
        return process

    with Linked(stage.endpoint, "mortal") as linked:
        linked.do(Watch(cameras=frozenset({LEFT})))
        born().end()
        born().end()


def test_levels_are_shown_while_the_microphones_are_wanted(stage: Stage) -> None:
    node = stage.hardware("ears", "virtual:", "--microphones", "tone")
    robot = stage.robot("ears", "hw")
    with Linked(stage.endpoint, "ears") as linked:
        linked.online("hw")
        linked.do(Watch(microphones=frozenset({"hw"})))
        linked.until(lambda world: world.levels.get("hw", (-120.0, -120.0))[0] > -100.0, "a level")
        linked.do(Watch())
        wait_status(robot, lambda status: not (status.microphones and status.microphones.streaming), "off")
        assert linked.world.levels == {}
    node.end()
