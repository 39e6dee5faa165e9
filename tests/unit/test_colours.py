"""The table of colours: readable everywhere, distinguishable by everybody, and used by every picture."""

from __future__ import annotations

import itertools

import numpy as np
import numpy.typing as npt
import pytest

from beatrix_zenoh import colours
from beatrix_zenoh.body.figure import Figure, meshes
from sim_node.model import build_spec

Colour = colours.Colour
EYES = {
    "all cones": np.eye(3),
    "no red cones": np.array(((0.1523, 1.0526, -0.2049), (0.1145, 0.7863, 0.0992), (-0.0039, -0.0481, 1.0520))),
    "no green cones": np.array(((0.3673, 0.8606, -0.2280), (0.2801, 0.6725, 0.0474), (-0.0118, 0.0429, 0.9689))),
}  # fmt: skip
"""What people see, in linear light (Machado, Oliveira and Fernandes 2009)."""


def linear(colour: Colour) -> npt.NDArray[np.float64]:
    part = np.array(colour) / 255
    return np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)


def lab(light: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return CIE L*a*b* of linear light."""
    to_xyz = np.array(((0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505)))
    x, y, z = np.cbrt(np.clip(to_xyz @ np.clip(light, 0, 1) / (0.9505, 1.0, 1.089), 0.0089, None))
    return np.array((116 * y - 16, 500 * (x - y), 200 * (y - z)))


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("table", [colours.ARMS, colours.AXES], ids=["arms", "axes"])
def test_the_colours_of_a_plot_are_distinguishable_with_colour_blindness(
    table: dict[str, Colour], eye: str
) -> None:
    seen = [lab(EYES[eye] @ linear(colour)) for colour in table.values()]
    assert min(np.linalg.norm(a - b) for a, b in itertools.combinations(seen, 2)) > 20


def test_models_and_viewer_use_the_table() -> None:
    model = build_spec().compile()
    for mesh in (mesh for mesh in meshes(Figure()) if mesh.body.startswith("arm_")):
        name = mesh.body.removeprefix("arm_")
        assert colours.ARMS[name] in {colour for colour, _ in mesh.solids()}
        assert model.material(name).rgba[:3] * 255 == pytest.approx(colours.ARMS[name], abs=0.01)
