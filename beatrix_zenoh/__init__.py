"""BEATRIX, the humanoid head for teaching robotics, over Zenoh.

with Robot("bea1", twin="sim") as robot:
    robot.enable()
    robot.calibrate()
    robot.look(yaw=20, pitch=-10)

Each name is imported when it is asked for: whoever needs one module of this package, as the command line
does while Ctrl-C is not yet in its hands, does not wait for all of them.
"""

from __future__ import annotations

__all__ = ["BeatrixError", "Interrupted", "NoAnswer", "Plan", "Refused", "Robot", "Twin"]
TYPE_CHECKING = False
"""Type checkers know this name; `typing` would cost a third of the time that is saved."""
if TYPE_CHECKING:
    from beatrix_zenoh.errors import BeatrixError as BeatrixError
    from beatrix_zenoh.errors import Interrupted as Interrupted
    from beatrix_zenoh.errors import NoAnswer as NoAnswer
    from beatrix_zenoh.errors import Refused as Refused
    from beatrix_zenoh.robot import Robot as Robot
    from beatrix_zenoh.twin import Plan as Plan
    from beatrix_zenoh.twin import Twin as Twin
else:
    HOMES = {
        "BeatrixError": "errors",
        "Interrupted": "errors",
        "NoAnswer": "errors",
        "Refused": "errors",
        "Robot": "robot",
        "Plan": "twin",
        "Twin": "twin",
    }

    def __getattr__(name):
        if name not in HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        import importlib  # noqa: PLC0415 - not before it is needed

        return getattr(importlib.import_module(f"{__name__}.{HOMES[name]}"), name)

    def __dir__():
        return sorted({*globals(), *HOMES})
