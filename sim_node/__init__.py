"""The simulated robot: the node of `beatrix_zenoh` with a virtual board and a MuJoCo model of the neck.

Importing this package imports MuJoCo without its OpenGL part: with MUJOCO_GL=egl or osmesa and without that
library, `import mujoco` would fail, although physics does not need it. The module `gl` loads OpenGL itself.
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
