"""The room of a simulation: the person, and the source of sound."""

from __future__ import annotations

from pathlib import Path

from beatrix_zenoh.client.degrees import checked_number, checked_seconds
from beatrix_zenoh.client.request import ask
from beatrix_zenoh.client.robot_base import RobotBase
from beatrix_zenoh.client.slips import value_method
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import (
    Reason,
    SoundQuery,
    SoundReply,
    TargetQuery,
    TargetReply,
)
from beatrix_zenoh.contract.errors import Refused, WrongUsage


class RobotWithRoom(RobotBase):
    """The part of a robot that changes the room of its simulation; hardware has none.

    x (forward), y (left) and z (up) are distances (m) from the neck's centre.
    """

    @value_method
    def target(self) -> TargetReply:
        """Return the place (m) of the simulated person in front of the robot: the middle between the eyes."""
        return self._ask_target(None)

    def move_target(self, x: float, y: float, z: float) -> TargetReply:
        """Place the middle between the eyes of the simulated person, and end the person's own path.

        Raises Refused for a place outside the room.
        """
        query = TargetQuery(
            x=checked_number("x", x, "m"), y=checked_number("y", y, "m"), z=checked_number("z", z, "m")
        )
        return self._ask_target(query)

    def walk_target(self, path: str = "sway", period_s: float = 12.0) -> TargetReply:
        """Let the simulated person walk a path from its beginning: `sway`, `circle`, or `still` to stand in front.

        `period_s` is the time (s) for once there and back, from 2 to 600. Raises Refused for another path or period.
        """
        return self._ask_target(TargetQuery(path=path, period_s=checked_seconds("period_s", period_s)))

    def _ask_target(self, query: TargetQuery | None) -> TargetReply:
        place = (self.name, "sim")
        reply = ask(self.client, place, keys.target(self.name), query, TargetReply, self.timeout_s)
        if query is not None and not reply.result:
            raise Refused(reply.reason, reply.message, reply.detail)
        return reply

    def place_sound(
        self, x: float | None = None, y: float | None = None, z: float | None = None
    ) -> SoundReply:
        """Place the source of sound in the simulated room; without a place, in the mouth of the simulated person.

        Raises Refused for a place outside the room or inside the head.
        """
        if x is None and y is None and z is None:
            return self._ask_sound(SoundQuery(mouth=True))
        if x is None or y is None or z is None:
            raise WrongUsage(Reason.BAD_VALUE, "A place needs x, y and z (m); without any, it is the mouth.")
        query = SoundQuery(
            x=checked_number("x", x, "m"), y=checked_number("y", y, "m"), z=checked_number("z", z, "m")
        )
        return self._ask_sound(query)

    def play_sound(self, sound: str | Path = "voice", seconds: float | None = None) -> SoundReply:
        """Play a sound in the simulated room, in place of the last one; returns at once.

        Args:
            sound: `clap` (one a second), `voice`, `noise`, `silence`, or the path of a WAV file of 16 bits.
            seconds: how long (s, at most 60); a shorter sound is repeated. By default 3 s, and a file once.

        Raises:
            Refused: BAD_VALUE: there is no such sound, or `seconds` is not allowed.
            WrongUsage: BAD_VALUE: the file cannot be read, has another format, or lasts longer than 10 s.
        """
        lasts_s = 0.0 if seconds is None else checked_seconds("seconds", seconds)
        path = Path(sound)
        if path.suffix.lower() != ".wav":
            return self._ask_sound(SoundQuery(play=str(sound), seconds=lasts_s))
        from beatrix_zenoh.client.sound import mono  # noqa: PLC0415 - numpy would delay every verb

        return self._ask_sound(SoundQuery(play="samples", seconds=lasts_s), mono(path))

    def _ask_sound(self, query: SoundQuery, samples: bytes | None = None) -> SoundReply:
        key, place = keys.sound(self.name), (self.name, "sim")
        reply = ask(self.client, place, key, query, SoundReply, self.timeout_s, samples)
        if not reply.result:
            raise Refused(reply.reason, reply.message, reply.detail)
        return reply
