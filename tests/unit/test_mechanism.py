"""The mechanism inside the robot: its axes meet in the neck centre, its parts touch, and MuJoCo hides it at first."""

from __future__ import annotations

import mujoco
import numpy as np

from beatrix_zenoh import colours
from beatrix_zenoh.recording.figure import Form, Solid
from beatrix_zenoh.recording.mechanism import AXIS_RADIUS
from sim_node.model import build_spec
from sim_node.picture import MECHANISM, add_mechanism
from sim_node.scene import scene_spec


def axes(solids: tuple[Solid, ...]) -> list[Solid]:
    return [solid for solid in solids if solid.form is Form.CAPSULE and solid.size[0] == AXIS_RADIUS]


def test_solids_are_where_the_figure_has_them_in_mujoco() -> None:
    spec = build_spec()
    add_mechanism(spec)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for name in colours.ARMS:
        # A link ends at the elbow of its arm, a rod at the mount of the head; hinges are centred there.
        for body, site in ((f"rod_{name}", f"mount_{name}"),):
            centres = data.geom_xpos[
                (model.geom_bodyid == model.body(body).id)
                & (model.geom_group == MECHANISM)
                & (model.geom_type == mujoco.mjtGeom.mjGEOM_CYLINDER)
            ]
            np.testing.assert_allclose(centres, [data.site(site).xpos], atol=1e-9)


def test_the_mechanism_is_hidden_at_first_and_changes_neither_masses_nor_contacts() -> None:
    plain, spec = build_spec().compile(), build_spec()
    add_mechanism(spec)
    model = spec.compile()
    added = model.geom_group == MECHANISM
    assert added.sum() > 30
    assert mujoco.MjvOption().geomgroup[MECHANISM] == 0
    assert not model.geom_contype[added].any()
    assert model.body_mass.tolist() == plain.body_mass.tolist()
    assert not (plain.geom_group == MECHANISM).any()
    assert not (scene_spec().compile().geom_group == MECHANISM).any(), "the eyes never draw it"
