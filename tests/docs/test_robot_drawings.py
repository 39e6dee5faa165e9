"""The drawings of wiring and parts follow from schemas/robot.toml."""

from __future__ import annotations

from xml.etree import ElementTree as ET

import pytest
import robot_drawings

from beatrix_zenoh.contract._generated.robot import ROBOT, SIZES


@pytest.mark.parametrize("name", robot_drawings.DRAWINGS)
def test_a_drawing_is_as_generated(name: str) -> None:
    drawn = robot_drawings.DRAWINGS[name]()
    assert (robot_drawings.IMAGES / name).read_text(encoding="utf-8") == drawn, "run tools/robot_drawings.py"


def test_the_wiring_names_every_pin() -> None:
    words = {element.text for element in ET.fromstring(robot_drawings.wiring()).iter()}
    assert {str(pin) for pin in (*ROBOT.pins.step, *ROBOT.pins.dir, ROBOT.pins.enable)} <= words


def test_the_page_has_the_sizes_of_the_model() -> None:
    text = (robot_drawings.IMAGES.parent / "how-to/build.md").read_text(encoding="utf-8")
    heights = [height - SIZES.floor for height in SIZES.ring_heights]
    sizes = [
        ROBOT.head.arm_length,
        -SIZES.floor,
        2 * SIZES.ring_radius,
        SIZES.ring_thickness,
        SIZES.post_radius,
    ]
    assert [
        size for size in (*sizes, *heights) if f"{1000 * size:.0f} mm" not in text.replace("\n", " ")
    ] == []
