"""State of the connection to a board: port, link, newest telemetry."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Protocol

from beatrix_zenoh.contract._generated import serial as wire
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.serial import HelloReply, Telemetry
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.schedule import Schedule
from beatrix_zenoh.threads import Owner

NO_TELEMETRY: Final = Telemetry(0, 0, 0, 0, 0, (0, 0, 0), (0, 0, 0), 0, 0)


class Port(Protocol):
    """A port that transfers bytes to and from a board."""

    @property
    def name(self) -> str:
        """Device path, or `virtual:`."""

    @property
    def boot_s(self) -> float:
        """Time (s) that the board needs to start if opening the port resets it."""

    def write(self, data: bytes) -> bytes:
        """Send all bytes; raises OSError if the port is gone.

        A virtual board returns its answer, which `read` returns as well; a serial port returns no bytes.
        """

    def wake(self) -> None:
        """Wake the threads that wait for written bytes; only a virtual board has such threads."""

    def read(self, timeout_s: float) -> bytes:
        """Return the received bytes, waiting up to `timeout_s` for the first; raises OSError if the port is gone."""

    def close(self) -> None:
        """Close the device and wake a waiting reader."""


class TimedPort(Port, Protocol):
    """The port of a virtual board, whose time passes in `read`, which does not wait."""

    def due_s(self) -> float:
        """Return the monotonic time (s) at which `read` should be called again."""

    def on_wake(self, notify: Callable[[], None]) -> None:
        """Let `wake` call `notify`, which must not wait."""


@dataclass(frozen=True)
class Turns:
    """How a virtual board gets its turns on a thread that it shares with the boards of other robots."""

    schedule: Schedule
    owner: Owner
    port: TimedPort


@dataclass(frozen=True)
class TelemetrySample:
    """Telemetry with its time on the host's clock."""

    telemetry: Telemetry
    t_mono_ns: int
    """`time.monotonic_ns()` at the tick of the telemetry"""


@dataclass(frozen=True)
class BoardLink:
    """State of the connection to the board."""

    port: str
    connected: bool
    trouble: str
    """why the board is not connected (port not open, other firmware, no frames); empty if it is connected"""
    hello: HelloReply | None
    rejected: int
    """number of invalid blocks received from the board"""
    overflowed: int
    """number of bytes that the board has dropped since its start because its buffer was full; 255: 255 or more"""
    retries: int
    """number of times that a request was sent again"""
    reset: bool
    """whether the connection was lost because the board was reset"""

    @property
    def name(self) -> str:
        """Robot name stored on the board, empty if none."""
        return "" if self.hello is None else self.hello.name.rstrip(b"\0").decode("ascii", "replace")

    @property
    def version(self) -> str:
        """Firmware version, empty if unknown."""
        return "" if self.hello is None else ".".join(map(str, self.hello.version))

    @property
    def boot(self) -> int:
        """Number of starts of the board, 0 if unknown."""
        return 0 if self.hello is None else self.hello.boot

    @property
    def understood(self) -> bool:
        """Whether the firmware has this program's contract."""
        return self.hello is not None and same_contract(self.hello)

    @property
    def contract_differs(self) -> bool:
        """Whether the firmware has another contract."""
        return self.hello is not None and not self.understood


def same_contract(hello: HelloReply) -> bool:
    """Return whether the firmware has this program's contract."""
    return hello.contract == wire.CONTRACT


def not_connected(link: BoardLink) -> NoAnswer:
    """Return the error for a request while the board is not connected."""
    if link.contract_differs:
        return NoAnswer(Reason.CONTRACT_MISMATCH, link.trouble)
    return NoAnswer(Reason.BOARD_LOST, f"The board does not answer its node: {link.trouble}")


def mismatch_text(hello: HelloReply) -> str:
    """Return the sentence about firmware of another version, or compiled with other values."""
    return (
        f"The firmware {'.'.join(map(str, hello.version))} has contract {hello.contract:08x}, this program has "
        f"{wire.CONTRACT:08x}: the firmware is of another version, or was built for another robot (microsteps, gears, "
        "guard, speed). End the programs that use the board and run `beatrix flash`, which installs this program's "
        "firmware. If you need the other firmware, use the program that was generated with it."
    )
