"""The source of sound in the room of a simulation: what it plays, and where it is."""

from __future__ import annotations

from pathlib import Path

from beatrix_zenoh.client.degrees import checked_number, checked_seconds
from beatrix_zenoh.client.request import ask
from beatrix_zenoh.client.robot_base import RobotBase
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason, SoundQuery, SoundReply
from beatrix_zenoh.contract.errors import Refused, WrongUsage


class RoomSound(RobotBase):
    """The part of a robot that plays sounds to its simulation, because hardware has no scene."""

    def place_sound(
        self, x: float | None = None, y: float | None = None, z: float | None = None
    ) -> SoundReply:
        """Place the source of sound in the simulated room; without a place, in the mouth of the simulated person.

        x (forward), y (left) and z (up) are distances (m) from the neck's centre. Raises Refused for a place outside
        the room or inside the head.
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
