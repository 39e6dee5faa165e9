"""BEATRIX, the humanoid head for teaching robotics, over Zenoh.

with Robot("bea1", side="sim") as robot:
    robot.enable()
    robot.calibrate()
    robot.look(yaw=20, pitch=-10)

Each name is imported at its first use, so that a program loads only the modules that it needs. The command line, for
example, must handle Ctrl-C before it loads other modules.
"""

from __future__ import annotations

__all__ = [
    "BeatrixError",
    "CameraImage",
    "Interrupted",
    "Monitor",
    "Motion",
    "NoAnswer",
    "Plan",
    "Refused",
    "Robot",
    "Subscription",
    "Twin",
    "suggestion",
]
TYPE_CHECKING = False
"""Type checkers treat this as True. Importing `typing` would cost a third of the time that late imports save."""
if TYPE_CHECKING:
    from beatrix_zenoh.client.camera import CameraImage as CameraImage
    from beatrix_zenoh.client.monitor import Monitor as Monitor
    from beatrix_zenoh.client.motion import Motion as Motion
    from beatrix_zenoh.client.readings import suggestion as suggestion
    from beatrix_zenoh.client.robot import Robot as Robot
    from beatrix_zenoh.client.subscription import Subscription as Subscription
    from beatrix_zenoh.client.twin.plan import Plan as Plan
    from beatrix_zenoh.client.twin.twin import Twin as Twin
    from beatrix_zenoh.contract.errors import BeatrixError as BeatrixError
    from beatrix_zenoh.contract.errors import Interrupted as Interrupted
    from beatrix_zenoh.contract.errors import NoAnswer as NoAnswer
    from beatrix_zenoh.contract.errors import Refused as Refused
else:
    MODULES = {
        "BeatrixError": "contract.errors",
        "CameraImage": "client.camera",
        "Interrupted": "contract.errors",
        "Monitor": "client.monitor",
        "Motion": "client.motion",
        "NoAnswer": "contract.errors",
        "Plan": "client.twin.plan",
        "Refused": "contract.errors",
        "Robot": "client.robot",
        "Subscription": "client.subscription",
        "Twin": "client.twin.twin",
        "suggestion": "client.readings",
    }

    def __getattr__(name):
        if name not in MODULES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        import importlib  # noqa: PLC0415 - not before it is needed

        from beatrix_zenoh import hiding  # noqa: PLC0415

        try:
            value = getattr(importlib.import_module(f"{__name__}.{MODULES[name]}"), name)
        except (ImportError, AttributeError) as error:
            # Python would report an AttributeError as "cannot import name", without its cause.
            why = hiding.cause(error) or f"{__name__}.{name} cannot be imported: {error}"
            raise ImportError(why, name=__name__) from error
        if why := hiding.imported():
            raise ImportError(why, name=__name__)
        return value

    def __dir__():
        return sorted({*globals(), *MODULES})
