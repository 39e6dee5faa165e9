"""A motion that outlives the process that asked for it.

A robot stops what a client asked for when that client's seat token goes. A session that announced
no seat has nothing to go.
"""

from __future__ import annotations

from collections.abc import Callable

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import codec
from beatrix_zenoh._generated.messages import MotionQuery, MotionReply, PoseQuery, Reason
from beatrix_zenoh.errors import NoAnswer, Refused
from beatrix_zenoh.robot import Robot


def hand_over(robot: Robot, key_of: Callable[[str, str, str], str], query: MotionQuery | PoseQuery) -> str:
    """Ask for a motion and leave once it is accepted; the robot's sentence.

    Raises:
        Refused: with the robot's reason.
        NoAnswer: nobody answered in time.
    """
    settings = robot.client.settings
    robot.status()  # says who is missing, which a query of its own could not
    with zbus.connect(settings.connect, label=settings.who) as bus:
        key = key_of(robot.name, robot.twin, settings.who)
        question = bus.question(key, codec.encode(query), codec.MSGPACK)
        try:
            answer = question.next(robot.timeout_s)
        except TimeoutError:
            raise NoAnswer(
                Reason.TIMED_OUT, f"{robot} did not answer within {robot.timeout_s:.1f} s."
            ) from None
    if answer is None or answer.error:
        raise NoAnswer(Reason.NO_ANSWER, f"{robot} did not take the motion; try again.")
    reply = codec.decode(answer.payload, MotionReply)
    if not reply.result:
        raise Refused(reply.reason, reply.message)
    return reply.message
