"""The robot of a program or verb that names none: the only one online."""

from __future__ import annotations

from collections.abc import Collection

from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer, Refused


def chosen_name(client: Client, *, acts: bool = True, present: Collection[Place] | None = None) -> str:
    """Return the name in the settings or, if they name none, that of the only robot online.

    A robot online under the default name `user-host` takes precedence over all others.

    Args:
        client: the session.
        acts: whether robots are moved or changed. Then the robot of an account counts as named: a student whose
            simulation is not running must not move the robot of the class by mistake.
        present: the robots online; None: ask the router, if they matter.

    Raises:
        NoAnswer: no robot is named, and none is online.
        Refused: no robot is named, and several are online.
    """
    settings = client.settings
    own = settings.account is not None and settings.account.robot
    if settings.named or (acts and own):
        return settings.robot
    if present is None:
        present = client.robots()
    if any(robot == settings.robot for robot, _ in present):
        return settings.robot
    return only_name(present, client.bus.endpoint)


def only_name(present: Collection[Place], endpoint: str) -> str:
    """Return the name of the only robot online; raises the errors of `chosen_name`."""
    found = sorted({robot for robot, _ in present})
    if not found:
        raise NoAnswer(
            Reason.NO_ANSWER,
            f"No robot is online at {endpoint}. Start a simulation with `beatrix sim` or `beatrix up`.",
        )
    if len(found) > 1:
        raise Refused(
            Reason.BAD_VALUE,
            f"Several robots are online: {', '.join(found)}. Choose one: with its name in a program, such as "
            f'Robot("{found[0]}"), with --name {found[0]} in a command, or with BEATRIX_ROBOT.',
        )
    return found[0]
