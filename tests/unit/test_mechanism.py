"""The mechanism inside the robot: MuJoCo hides it at first."""

from __future__ import annotations

import mujoco

from sim_node.model import build_spec
from sim_node.picture import MECHANISM, add_mechanism
from sim_node.scene import scene_spec


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
