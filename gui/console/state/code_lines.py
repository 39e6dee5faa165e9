"""Requests as Python, and as a whole program."""

from __future__ import annotations

import math
from collections.abc import Sequence

from beatrix_zenoh.client.degrees import arm_angles
from beatrix_zenoh.contract._generated.messages import Command, LeaseAction, MotionQuery, PoseQuery
from beatrix_zenoh.contract.names import SIDES
from beatrix_zenoh.settings import DEFAULT_ENDPOINT
from gui.console.state.actions import POSES, AskLease, MakeReady, Play, Send, SendCommand
from gui.console.state.memory import Request, sides_of
from gui.console.state.world import World


def program(lines: Sequence[str], world: World, title: str) -> str:
    """Return the text of a whole program that runs these lines of `python` on the robot of the window.

    `title` is the docstring of the program. It names router and seat only if it would choose others by itself.
    """
    calls = [line for line in lines if not line.startswith("#")]
    imports = ["from beatrix_zenoh import Twin"]
    if any(call.lstrip().startswith("play(") for call in calls):
        plays = {word for call in calls for word in ("ArmPose", "Choreography", "load") if f"{word}(" in call}
        imports.append(f"from beatrix_zenoh.client.choreography import {', '.join((*sorted(plays), 'play'))}")
    words = [f'"{world.robot}"']
    words += [f'connect="{world.endpoint}"'] if world.endpoint != DEFAULT_ENDPOINT else []
    words += [f'who="{world.who}"'] if world.who else []
    head = [f'"""{title}"""', "", *imports, "", f"with Twin({', '.join(words)}) as twin:"]
    body = lines if calls else [*lines, "pass"]
    return "\n".join((*head, *(f"    {line}" for line in body), ""))


def python(request: Request) -> str:
    """Return Python that sends the request with `twin`, one line; for a play of poses, one for each, and played once.

    Empty if there is none.
    """
    sides = sides_of(request) or SIDES
    both = len(sides) > 1
    robot = "twin" if both else f"twin.{sides[0]}"
    text = ""
    match request:
        case Send(query=query, lead_s=lead_s):
            text = _motion_python(query, robot, lead_s, both=both)
        case SendCommand(command=command, value=value) if command is not Command.EMERGENCY_STOP:
            verb = command.name.lower() if value else "disable"
            text = f"{robot}.{verb}()"
        case MakeReady():
            text = f"{robot}.make_ready()"
        case AskLease(action=LeaseAction.TAKE):
            text = f"{robot}.lease()"
        case AskLease(action=LeaseAction.WAIT):
            text = f"{robot}.lease(wait_s=60)"
        case Play():
            text = _play_python(request, robot, both=both)
    return text


def _play_python(request: Play, robot: str, *, both: bool) -> str:
    """Return the lines of a play, which contain the time of each pose, so that pauses are repeated as well."""
    lead = f", lead_s={_number(request.lead_s)}" if request.lead_s and both else ""
    if request.gesture:
        return f"play({robot}, load({request.gesture!r}){lead})"
    steps = [
        f'    ("{POSES}", ArmPose({", ".join(map(_number, (pose.at, pose.short, pose.middle, pose.long, pose.speed)))})),'
        for pose in request.poses
    ]
    words = "at, short, middle, long, speed"
    return "\n".join([f"play({robot}, Choreography([  # {words}", *steps, f"]){lead})"])


def _motion_python(query: MotionQuery | PoseQuery, robot: str, lead_s: float, *, both: bool) -> str:
    if isinstance(query, PoseQuery):
        call = "preview" if both else "look"
        angles = [f"{name}={text}" for name, text in _head(query).items()]
        speed = None if query.speed is None else _number(math.degrees(query.speed))
    else:
        call = "preview_arms" if both else "move"
        angles = [_number(angle) for angle in arm_angles(query.position)]
        speeds = _speeds(query)
        speed = speeds[0] if len(speeds) == 1 else f"({', '.join(speeds)})" if speeds else None
    words = [*angles, *([] if query.absolute else ["relative=True"]), *([f"speed={speed}"] if speed else [])]
    return f"{robot}.{call}({', '.join(words)})" + (_commit(lead_s) if both else "")


def _commit(lead_s: float) -> str:
    return f".commit({f'lead_s={_number(lead_s)}' if lead_s else ''})"


def _head(query: PoseQuery) -> dict[str, str]:
    angles = {"yaw": query.yaw, "pitch": query.pitch, "roll": query.roll}
    return {name: _number(math.degrees(angle)) for name, angle in angles.items()}


def _speeds(query: MotionQuery) -> list[str]:
    """Return one speed (deg/s) if all are equal, else three; an empty list for the robot's default."""
    if query.speed is None:
        return []
    speeds = [_number(speed) for speed in arm_angles(query.speed)]
    return speeds[:1] if len(set(speeds)) == 1 else speeds


def _number(value: float) -> str:
    """Return a number as text, with at most three decimals and no trailing zeros."""
    return f"{round(value, 3) + 0.0:.10g}"
