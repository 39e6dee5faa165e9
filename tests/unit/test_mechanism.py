"""The mechanism inside the robot: MuJoCo hides it at first."""

from __future__ import annotations

import mujoco
import numpy as np

from beatrix_zenoh import colours
from sim_node.model import build_spec, scene_spec
from sim_node.viewer import MECHANISM, add_mechanism


def test_joints_are_where_the_model_has_them() -> None:
    spec = build_spec()
    add_mechanism(spec)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for name in colours.ARMS:  # the joint of a rod is the second of its solids
        geoms = np.flatnonzero(
            (model.geom_bodyid == model.body(f"rod_{name}").id) & (model.geom_group == MECHANISM)
        )
        np.testing.assert_allclose(data.geom_xpos[geoms[1]], data.site(f"mount_{name}").xpos, atol=1e-6)


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
