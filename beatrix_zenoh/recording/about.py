"""What a recording says of itself: its title, its robots and their versions, and who took part."""

from __future__ import annotations

from datetime import UTC, datetime
from importlib import metadata

import msgspec

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract._generated import messages
from beatrix_zenoh.contract._generated.messages import Info

DISTRIBUTION = "beatrix-zenoh"


class RobotAbout(msgspec.Struct, frozen=True):
    """A robot of a recording, in its own words."""

    robot: str
    side: str
    """`hw` or `sim`"""
    version: str
    """version of beatrix-zenoh of its node"""
    contract: str
    """hash of its Zenoh messages and keys"""
    firmware: str
    """version of the firmware; empty: no board"""
    fingerprint: str
    """hash of all values of the robot file; empty: not known"""

    def __str__(self) -> str:
        firmware = f"firmware {self.firmware}" if self.firmware else "no board"
        file = f", robot file {self.fingerprint}" if self.fingerprint else ""
        return (
            f"{self.robot} ({self.side}): beatrix {self.version}, {firmware}, contract {self.contract}{file}"
        )


class About(msgspec.Struct, frozen=True):
    """A recording, as it describes itself."""

    began_ns: int
    """start of the recording by the wall clock of the recording computer, since 1970"""
    version: str = ""
    """version of beatrix-zenoh of the recorder"""
    contract: str = ""
    """hash of the Zenoh messages and keys of the recorder"""
    title: str = ""
    note: str = ""
    """what the user wrote about the recording at its start"""
    seat: str = ""
    """seat that recorded"""
    robots: tuple[RobotAbout, ...] = ()
    seats: tuple[str, ...] = ()
    """seats that have sent requests or notes, sorted"""

    def heading(self) -> str:
        """Return title, start, seat and version as a sentence."""
        began = datetime.fromtimestamp(self.began_ns / 1e9, UTC)
        by = f" by {self.seat}" if self.seat else ""
        return f"{self.title or 'Recording'}, begun {began:%Y-%m-%d %H:%M:%S} UTC{by} with beatrix {self.version}."

    def warnings(self) -> list[str]:
        """Return a sentence for each robot whose simulation and hardware have different values."""
        files: dict[str, set[str]] = {}
        for one in self.robots:
            if one.fingerprint:
                files.setdefault(one.robot, set()).add(one.fingerprint)
        return [
            f"Simulation and hardware of {name} were started with different robot files: limits or geometry differ."
            for name, found in files.items()
            if len(found) > 1
        ]

    def lines(self) -> list[str]:
        """Return these facts as sentences for people; the first names the title."""
        notes = [f"Note: {self.note}"] if self.note else []
        found = [self.heading(), *notes, *(f"{robot}." for robot in self.robots), *self.warnings()]
        return [*found, f"Requests and notes came from {', '.join(self.seats)}."] if self.seats else found

    def with_robot(self, place: Place, info: Info) -> About:
        """Return these facts with those of a robot, in place of earlier ones."""
        found = RobotAbout(*place, info.version, info.contract, info.firmware, info.fingerprint or "")
        others = [one for one in self.robots if (one.robot, one.side) != place]
        robots = sorted([*others, found], key=lambda one: (one.robot, one.side))
        return msgspec.structs.replace(self, robots=tuple(robots))

    def with_seat(self, seat: str) -> About:
        """Return these facts with a seat that takes part."""
        if not seat or seat in self.seats:
            return self
        return msgspec.structs.replace(self, seats=tuple(sorted({*self.seats, seat})))


def about(began_ns: int, *, title: str = "", note: str = "", seat: str = "") -> About:
    """Return the facts of a recording that this program begins."""
    return About(began_ns, metadata.version(DISTRIBUTION), messages.CONTRACT, title, note, seat)
