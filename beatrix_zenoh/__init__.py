"""BEATRIX, the humanoid head for teaching robotics, over Zenoh.

with Robot("bea1", side="sim") as robot:
    robot.enable()
    robot.calibrate()
    robot.look(yaw=20, pitch=-10)

The names are imported at the first use of one, because the command line must handle Ctrl-C before it loads other
modules.
"""

from __future__ import annotations

# ruff: noqa: F405 - `client` defines the names

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
    from beatrix_zenoh.client import *  # noqa: F403 - `__all__` above lists what programs use
else:

    def __getattr__(name):
        if name not in __all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        import importlib  # noqa: PLC0415 - not before it is needed

        from beatrix_zenoh import hiding  # noqa: PLC0415

        try:
            client = importlib.import_module("beatrix_zenoh.client")
            value = getattr(client, name)
        except (ImportError, AttributeError) as error:
            # Python would report an AttributeError as "cannot import name", without its cause.
            if why := hiding.cause(error):
                raise ImportError(why, name=__name__) from None
            raise ImportError(f"{__name__}.{name} cannot be imported: {error}", name=__name__) from error
        if why := hiding.unfit(hiding.search_path()[0]):
            raise ImportError(why, name=__name__)
        from beatrix_zenoh.contract import tracebacks  # noqa: PLC0415

        tracebacks.install(client.BeatrixError, lambda error: error.data)
        return value

    def __dir__():
        return sorted({*globals(), *__all__})
