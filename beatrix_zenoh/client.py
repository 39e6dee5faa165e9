"""A client's session: its seat is announced, and silence becomes a sentence."""

from __future__ import annotations

import time
from typing import Self, TypeVar

import msgspec

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import codec
from beatrix_zenoh._generated import keys
from beatrix_zenoh._generated.messages import MotionReply, Reason
from beatrix_zenoh.bus import Answer, Bus, Question
from beatrix_zenoh.errors import NoAnswer
from beatrix_zenoh.settings import Settings

STALE_S = 0.02
"""After a node's restart a kept session may ask into the void for this long (zenoh#2767)."""

M = TypeVar("M", bound=msgspec.Struct)


class Client:
    """One Zenoh session under one seat; robots of this process share it.

    While it lives its seat is announced, so that a robot notices when it has gone and stops what
    it asked for.
    """

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.bus: Bus = zbus.connect(settings.connect, label=settings.who)
        self.bus.announce(keys.seat(settings.who, self.bus.session_id))

    def ask(
        self, robot: str, twin: str, key: str, request: msgspec.Struct | None, kind: type[M], timeout_s: float
    ) -> M:
        """Ask one robot and return its one reply.

        Raises:
            NoAnswer: NO_ANSWER or TIMED_OUT, saying who is on line and what to do.
        """
        with Conversation(self, robot, twin, key, request) as conversation:
            return conversation.next(kind, timeout_s)

    def close(self) -> None:
        """Leave; what this session asked for and still runs is stopped by the robots."""
        self.bus.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


class Conversation:
    """One query and its replies, asked again once if nobody heard it."""

    def __init__(
        self, client: Client, robot: str, twin: str, key: str, request: msgspec.Struct | None
    ) -> None:
        self._bus, self._robot, self._twin, self._key = client.bus, robot, twin, key
        self._payload = None if request is None else codec.encode(request)
        self._heard = False
        self._question = self._ask()

    def _ask(self) -> Question:
        return self._bus.question(self._key, self._payload, codec.MSGPACK, priority(self._key))

    def next(self, kind: type[M], timeout_s: float) -> M:
        """The next reply, waiting up to `timeout_s`; raises NoAnswer as `Client.ask`, TIMED_OUT too."""
        deadline = time.monotonic() + timeout_s
        try:
            answer = self._question.next(timeout_s)
            if answer is None and not self._heard:
                answer = self._again(deadline)
        except TimeoutError:
            raise NoAnswer(
                Reason.TIMED_OUT,
                f"{self._name()} did not answer within {timeout_s:.1f} s: it is frozen or very busy.",
            ) from None
        if answer is None:
            raise self._silence()
        self._heard = True
        if answer.error:
            text = answer.payload.decode(errors="replace")
            raise NoAnswer(Reason.NO_ANSWER, f"{self._name()} answered with an error: {text}")
        return codec.decode(answer.payload, kind)

    def _again(self, deadline: float) -> Answer | None:
        """Just after a node's restart the first query can be lost: ask once more."""
        time.sleep(STALE_S)
        self._question.close()
        self._question = self._ask()
        return self._question.next(deadline - time.monotonic())

    def _silence(self) -> NoAnswer:
        present = self._bus.robots() if self._bus.connected else []
        # The session may not have noticed yet.
        if not self._bus.connected or not zbus.listens(self._bus.endpoint):
            return NoAnswer(
                Reason.NO_ROUTER,
                f"The router at {self._bus.endpoint} has gone, so robots end their motions; all is back when it is.",
            )
        if (self._robot, self._twin) in present:
            text = f"{self._name()} is on line but did not answer: refused by the router, or just closing."
        else:
            others = ", ".join(f"{robot} ({twin})" for robot, twin in present) or "nobody"
            text = (
                f"{self._name()} is not on line at {self._bus.endpoint}. On line: {others}. "
                f"Start it with `beatrix {self._twin} --name {self._robot}`, or choose with --name and --on."
            )
            if self._heard and self._twin == "hw":
                text += " The board stops by itself, half a second after it last heard its node."
        return NoAnswer(Reason.NO_ANSWER, text)

    def _name(self) -> str:
        return f"{self._robot} ({self._twin})"

    def stop_if_accepted(self, stop_key: str) -> None:
        """Nobody waits for this motion any more: should the robot accept it late, it is stopped."""

        def stop(answer: Answer) -> None:
            if not answer.error and codec.decode(answer.payload, MotionReply).result:
                self._bus.put(stop_key, b"", codec.MSGPACK, "real_time")

        self._question.hand_over(stop)

    def close(self) -> None:
        """Wait for no more replies."""
        self._question.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()


def priority(key: str) -> str:
    """How urgent a question is: STOP overtakes what this session has sent before, streams of motions nothing."""
    road = key.rpartition("/")[2]
    if road == "stop":
        return "real_time"
    return "data" if road in ("motion", "pose", "preview") else "interactive_high"
