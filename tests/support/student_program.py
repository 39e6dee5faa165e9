"""A program that acts as a seat of a class: evaluates each line of its input, and prints `= result` or `! error`.

It uses the account that `beatrix.toml` of its working folder names, as the programs of a student do.
"""

from __future__ import annotations

import sys
from functools import cache

from patient_connections import PATIENCE_S, patiently

from beatrix_zenoh import Robot as OneRobot
from beatrix_zenoh.client import Client
from beatrix_zenoh.client.stopping import publish_stop
from beatrix_zenoh.settings import resolve


@cache
def client() -> Client:
    """Return the client of this program; the first call connects it."""
    return patiently(lambda: Client(resolve()))


@cache
def robot(name: str) -> OneRobot:
    """Return the hardware of a robot of the class."""
    return OneRobot(name, "hw", client=client(), timeout_s=PATIENCE_S)


def stop_all() -> None:
    """Publish STOP for all robots."""
    publish_stop(client(), ("*", "*"))


def ready(name: str) -> str:
    """Make a robot ready to move; return its name."""
    robot(name).make_ready()
    return name


def begin(name: str, yaw: float, speed: float = 10.0) -> str:
    """Begin a motion of the head; yaw in deg, speed in deg/s. Return the robot's name."""
    robot(name).look(yaw=yaw, speed=speed, wait=False)
    return name


def yaw(name: str) -> float:
    """Return the commanded angle of the short arm (deg), rounded to 0.1; it is the yaw of an upright head."""
    return round(robot(name).positions().commanded.short, 1)


def main() -> None:
    """Evaluate lines until the end of the input."""
    print("ready", flush=True)
    for line in sys.stdin:
        try:
            result = eval(line, globals())
        except Exception as error:  # noqa: BLE001  # the test reads the error
            print("!", type(error).__name__, str(error).replace("\n", " "), flush=True)
        else:
            print("=", repr(result), flush=True)
    if client.cache_info().currsize:
        client().close()


if __name__ == "__main__":
    main()
