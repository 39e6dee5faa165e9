"""Write the tables and the tree of docs/explanation/neck.md, and its pictures: `python tools/neck_page.py`.

A test checks that the page is up to date.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import mujoco
from robot_pictures import write_mechanism

from beatrix_zenoh.client.degrees import ArmAngles, HeadAngles, path_figure
from beatrix_zenoh.client.degrees import Path as ArmsPath
from beatrix_zenoh.contract._generated.robot import ROBOT
from beatrix_zenoh.motion.kinematics import Neck
from beatrix_zenoh.motion.trajectory import plan
from sim_node.model import build_spec

DOCS: Final = Path(__file__).resolve().parent.parent / "docs"
PAGE: Final = DOCS / "explanation/neck.md"
BLOCK: Final = re.compile(r"(<!-- begin (\w+)[^>]*-->\n).*?(<!-- end -->)", re.DOTALL)
TURN_DEG: Final = 20.0
PATTERNS: Final = (
    ("short", (1, 0, 0)),
    ("middle", (0, 1, 0)),
    ("long", (0, 0, 1)),
    ("all three", (1, 1, 1)),
    ("short, and the others half as far back", (1, -0.5, -0.5)),
    ("long, and middle as far back", (0, -1, 1)),
)
"""Title of a row, and how far each arm turns in units of TURN_DEG."""
SWING_DEG: Final = 40.0
SPEEDS: Final = (80.0, 40.0, 40.0)
"""Speeds of short, middle and long (deg/s)."""
ACCELERATION: Final = ROBOT.limits.acceleration
STEPS: Final = 120
ROWS: Final = 6


def arms_table() -> str:
    """Return a table of the head orientation for each of PATTERNS, in degrees."""
    neck = Neck()
    rows = [f"| arms turned by {TURN_DEG:.0f}° | yaw | pitch | roll |", "|---|---|---|---|"]
    for title, pattern in PATTERNS:
        head = neck.forward([math.radians(TURN_DEG * share) for share in pattern])
        angles = " | ".join(f"{math.degrees(angle):+z.1f}°".replace("+0.0", "0.0") for angle in head)
        rows.append(f"| {title} | {angles} |")
    return "\n".join(rows) + "\n"


def uneven_path() -> ArmsPath:
    """Return the path of a motion that turns all arms by SWING_DEG with SPEEDS, from home."""
    neck = Neck()
    ways = (math.radians(SWING_DEG),) * 3
    x, y, z = (math.radians(speed) for speed in SPEEDS)
    trajectory = plan((0.0,) * 3, (0.0,) * 3, ways, (x, y, z), math.radians(ACCELERATION), straight=False)
    times = [trajectory.duration * step / STEPS for step in range(STEPS + 1)]
    arms = [trajectory.at(t)[0] for t in times]
    return ArmsPath(
        times,
        [ArmAngles(*map(math.degrees, angles)) for angles in arms],
        [HeadAngles(*map(math.degrees, neck.forward(angles))) for angles in arms],
    )


def tilt(arms: Sequence[float]) -> float:
    """Return the angle (deg) between the head's axis and the vertical, for arm angles (rad)."""
    _, pitch, roll = Neck().forward(arms)
    return math.degrees(math.acos(math.cos(pitch) * math.cos(roll)))


def speeds_table() -> str:
    """Return a table of `uneven_path`: arms, head and tilt at some times."""
    path = uneven_path()
    rows = ["| time | short | middle, long | yaw | pitch | roll | lean |", "|---|---|---|---|---|---|---|"]
    for step in range(0, STEPS + 1, STEPS // ROWS):
        arms = path.arms[step]
        shown = (arms.short, arms.middle, *path.head[step], tilt([math.radians(arm) for arm in arms]))
        angles = " | ".join(f"{angle:z.1f}°" for angle in shown)
        rows.append(f"| {path.t[step]:.1f} s | {angles} |")
    return "\n".join(rows) + "\n"


def model_tree() -> str:
    """Return a tree of the bodies of the simulation with their joints, motors, cameras and loops."""
    return "```text\nworld\n" + "\n".join(_branches(build_spec().compile(), 0, "")) + "\n```\n"


def _branches(model: mujoco.MjModel, parent: int, indent: str) -> Iterator[str]:
    children = [body for body in range(1, model.nbody) if model.body_parentid[body] == parent]
    for body in children:
        last = body == children[-1]
        name = indent + ("└─ " if last else "├─ ") + model.body(body).name
        yield f"{name:<18}{_parts(model, body)}"
        yield from _branches(model, body, indent + ("   " if last else "│  "))


def _parts(model: mujoco.MjModel, body: int) -> str:
    """Return the joint, the motor, the cameras and the loops of a body as text."""
    ball = mujoco.mjtJoint.mjJNT_BALL
    joint = int(model.body_jntadr[body])
    parts = ["ball joint" if model.jnt_type[joint] == ball else "hinge"]
    parts += [
        f"motor {model.actuator(i).name}" for i in range(model.nu) if model.actuator_trnid[i, 0] == joint
    ]
    parts += [f"camera {model.camera(i).name}" for i in range(model.ncam) if model.cam_bodyid[i] == body]
    for loop in range(model.neq):
        rod, mount = (int(site[loop]) for site in (model.eq_obj1id, model.eq_obj2id))
        if model.site_bodyid[rod] == body:
            head = model.body(int(model.site_bodyid[mount])).name
            parts.append(f"{model.equality(loop).name}: its end stays at {model.site(mount).name} of {head}")
    return ", ".join(parts)


def page(text: str) -> str:
    """Return the text of a page with new generated blocks."""
    blocks = {"arms": arms_table(), "speeds": speeds_table(), "model": model_tree()}
    return BLOCK.sub(lambda found: found[1] + blocks[found[2]] + found[3], text)


if __name__ == "__main__":
    write_mechanism(DOCS / "images/mechanism.png")
    path_figure(uneven_path()).savefig(DOCS / "images/speeds.png", dpi=80)
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
