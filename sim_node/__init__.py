"""The simulated robot: the node of `beatrix_zenoh` around a virtual board and a MuJoCo neck.

Importing this package imports MuJoCo without its OpenGL part: with MUJOCO_GL=egl or osmesa and no such
library installed, `import mujoco` itself would fail, and physics needs none. `picture` opens OpenGL itself.
"""

from __future__ import annotations

import os

_wish = os.environ.get("MUJOCO_GL")
os.environ["MUJOCO_GL"] = "off"
try:
    import mujoco as mujoco
finally:
    del os.environ["MUJOCO_GL"]
    if _wish is not None:
        os.environ["MUJOCO_GL"] = _wish
