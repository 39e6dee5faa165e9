"""Leases of the SDK: a program takes a robot for longer than a motion; the teacher freezes robots and limits speeds."""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed

from beatrix_zenoh.bus import ProcessBound
from beatrix_zenoh.client.degrees import checked_number
from beatrix_zenoh.client.request import GroupRequest, Request, accepted, outcome
from beatrix_zenoh.client.request import ask as ask_robot
from beatrix_zenoh.client.robot_base import RobotBase
from beatrix_zenoh.client.session import Client, Closable, Place
from beatrix_zenoh.client.subscription import SILENCE_S
from beatrix_zenoh.contract import refusals
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import LeaseAction, LeaseQuery, LeaseReply, Reason, Status
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer, Refused, wrong_usage

ANSWER_S = 2.0
"""Time limit (s) of the reply of each robot."""
ABSENT = (Reason.NODE_LOST, Reason.NO_ANSWER, Reason.NO_SUCH_ROBOT, Reason.NODE_HANGS, Reason.TIMED_OUT)
"""Reasons of a robot that is not there, but may return."""
SEAT_S = 1.0
"""Time limit (s) of the robot of a seat: its token may be all there is, and must not hold up the teacher."""
AT_ONCE = 128
"""Largest number of robots that are waited for at the same time; a class has at most two for each account."""
NO_REPLY = (
    f"The robot did not answer within {ANSWER_S:g} s, so its state is not known: its node hangs or is not connected. "
    "Send the request again when the robot answers."
)


class Lease(ProcessBound, Closable):
    """A robot that this program has taken: `with robot.lease(): …`.

    Motions carry its number, so that the robot refuses those of a lease that has ended.
    """

    def __init__(
        self,
        robot: RobotBase,
        wait_s: float,
        *,
        longest_s: float = 0.0,
        speed: float = 0.0,
        told: Callable[[Status | None], None] = lambda _: None,
    ) -> None:
        """Take the robot; `longest_s` (s) and `speed` (rad/s) are those of the lease query.

        `told` is called with each status of the robot while this seat waits, and with None while the robot is silent.
        """
        self._robot = robot
        self._given = bool(robot.given_lease) and robot.lease_number == robot.given_lease
        self.number: int = robot.given_lease
        """Number of the lease, which motions carry."""
        if not self._given:
            action = LeaseAction.WAIT if wait_s > 0 else LeaseAction.TAKE
            self.number = take(
                robot, wait_s, LeaseQuery(action=action, speed=speed, longest_s=longest_s), told
            )
        robot.lease_number = self.number

    def close(self) -> None:
        """Give the robot back. If this raises NoAnswer, the lease ends with the session of this program."""
        if self._robot.lease_number == self.number and not self._given:
            self._robot.lease_number = 0
            ask(self._robot, LeaseAction.GIVE_BACK)


def take(robot: RobotBase, wait_s: float, query: LeaseQuery, told: Callable[[Status | None], None]) -> int:
    """Take a robot, wait for it up to `wait_s` (s) if necessary, and return the number of the lease; raises Refused."""
    reply = send(robot, query)
    if reply.lease:
        return reply.lease
    deadline_s = time.monotonic() + wait_s
    try:
        holder = _wait_for_turn(robot, reply.holder, deadline_s, query, told)
    except BaseException:
        ask(robot, LeaseAction.GIVE_BACK)
        raise
    if holder:
        ask(robot, LeaseAction.GIVE_BACK)
        raise refusals.taken_by(holder)
    return send(robot, query).lease


def _wait_for_turn(
    robot: RobotBase, holder: str, deadline_s: float, query: LeaseQuery, told: Callable[[Status | None], None]
) -> str:
    """Wait for the lease; return "", or the seat that still holds the robot at `deadline_s` (monotonic clock, s).

    The robot removes the seat from its queue when its node restarts, the session is disconnected, or another program
    of the seat gives up; then the request is sent again. A robot that is lost may return: the seat waits for it.
    """
    seat = robot.client.settings.who
    with robot.status_stream() as statuses:
        while (left_s := deadline_s - time.monotonic()) > 0:
            try:
                status: Status = statuses.next(min(left_s, SILENCE_S))
            except NoAnswer as error:
                if error.reason is not Reason.TIMED_OUT:
                    raise
                told(None)
                continue
            if status.holder == seat and status.lease:
                return ""
            holder = status.holder
            told(status)
            if seat not in status.waiting and _again(robot, query):
                return ""
    return holder


def _again(robot: RobotBase, query: LeaseQuery) -> bool:
    """Send a request again, and return whether the robot is this seat's now; a robot that starts may not answer yet."""
    try:
        return bool(send(robot, query).lease)
    except NoAnswer as error:
        if error.reason not in (*ABSENT, Reason.NO_ROUTER):
            raise
        return False


def limit_of(speed: float) -> float:
    """Return a speed limit in rad/s from one in deg/s; raises WrongUsage (BAD_VALUE) unless it is above 0."""
    if checked_number("speed", speed, "deg/s") <= 0:
        raise wrong_usage(
            f"A speed limit of {speed:g}°/s is not allowed: give more than 0. `beatrix freeze` stops all robots; "
            "`beatrix limit off` ends the limit.",
        )
    return math.radians(speed)


def ask(robot: RobotBase, action: LeaseAction, speed: float = 0.0, seat: str = "") -> LeaseReply:
    """Send a lease query; `speed` (rad/s) is for LIMIT, `seat` for MUTE and UNMUTE. Raises Refused or NoAnswer."""
    return send(robot, LeaseQuery(action=action, speed=speed, seat=seat))


def send(robot: RobotBase, query: LeaseQuery) -> LeaseReply:
    """Send a lease query; raises Refused or NoAnswer."""
    key = keys.lease(robot.name, robot.side, robot.client.settings.who)
    return accepted(ask_robot(robot.client, robot.place, key, query, LeaseReply, robot.timeout_s))


def govern(
    client: Client, places: Sequence[Place], query: LeaseQuery
) -> Iterator[tuple[Place, LeaseReply | BeatrixError]]:
    """Send a lease query to all these robots at once, and yield the reply or error of each as it arrives.

    The robots of the class are the first, before those of seats, for which `of_seat` is true.
    """
    ordered = sorted(places, key=lambda place: (of_seat(client, place), place[1] != "hw", place))
    with ThreadPoolExecutor(AT_ONCE, "beatrix-govern") as threads:
        asked = {threads.submit(_ask, client, place, query): place for place in ordered}
        for answered in as_completed(asked):
            yield asked[answered], answered.result()


def refused(client: Client, results: Mapping[Place, LeaseReply | BeatrixError]) -> bool:
    """Return whether all robots of the class that were reached refused the query, as the others would, too."""
    found = [isinstance(result, Refused) for place, result in results.items() if not of_seat(client, place)]
    return bool(found) and all(found)


def pending(client: Client, query: LeaseQuery | None = None, robots: Collection[str] = ()) -> dict[str, str]:
    """Return what the router of the class will send to its robots that are not online, as text by name.

    First let it keep one more decision for `robots`, by default for all of the class; call this after `govern`. Empty
    without the account of a teacher, and if no router of a class answers.
    """
    account = client.settings.account
    if account is None or account.role != "teacher":
        return {}
    found: dict[str, str] = {}
    for name in robots or ["*"]:
        request = GroupRequest(client, keys.pending(name, "*"), query, LeaseReply, SEAT_S)
        found |= {robot: reply.message for (robot, _), reply in request.replies(SEAT_S)}
    return dict(sorted(found.items()))


def of_seat(client: Client, place: Place) -> bool:
    """Return whether this is known as the robot of a seat: in a class, to the teacher."""
    account = client.settings.account
    return account is not None and account.of_seat(place[0])


def _ask(client: Client, place: Place, query: LeaseQuery) -> LeaseReply | BeatrixError:
    """Return the reply of a robot that arrives within ANSWER_S, or the error; of a seat's robot within SEAT_S."""
    if of_seat(client, place):
        return _ask_seats(client, place, query)
    request = Request(client, place, keys.lease(*place, client.settings.who), query, ANSWER_S)
    try:
        reply = request.reply(LeaseReply, ANSWER_S)
    except TimeoutError:
        return NoAnswer(Reason.TIMED_OUT, NO_REPLY)
    except BeatrixError as error:
        return error
    finally:
        request.close()
    return outcome(reply)


def _ask_seats(client: Client, place: Place, query: LeaseQuery) -> LeaseReply | BeatrixError:
    """Return the reply or the error of a seat's robot, without a search for the cause, which takes seconds."""
    request = GroupRequest(client, keys.lease(*place, client.settings.who), query, LeaseReply, SEAT_S)
    with contextlib.closing(request):
        for _, reply in request.replies(SEAT_S):
            return outcome(reply)
    return NoAnswer(Reason.TIMED_OUT, f"The robot of this seat did not answer within {SEAT_S:g} s.")
