"""The simulated robot: the node of `beatrix_zenoh` with a virtual board and a MuJoCo model of the neck.

Importing this package imports MuJoCo without its OpenGL part: if MUJOCO_GL is `egl` or `osmesa` and this library is
missing, `import mujoco` would fail, although physics does not need OpenGL. The module `gl` loads OpenGL itself.
"""

from __future__ import annotations

import os

_preferred = os.environ.get("MUJOCO_GL")
os.environ["MUJOCO_GL"] = "off"
try:
    import mujoco as mujoco
finally:
    del os.environ["MUJOCO_GL"]
    if _preferred is not None:
        os.environ["MUJOCO_GL"] = _preferred
