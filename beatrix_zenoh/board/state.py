"""The port of a board, and its newest telemetry."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Protocol

from beatrix_zenoh.contract._generated import serial as wire
from beatrix_zenoh.contract._generated.serial import HelloReply, Telemetry

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


@dataclass(frozen=True)
class TelemetrySample:
    """Telemetry with its time on the host's clock."""

    telemetry: Telemetry
    t_mono_ns: int
    """`time.monotonic_ns()` at the tick of the telemetry"""


def mismatch_text(hello: HelloReply) -> str:
    """Return the sentence about firmware of another version, or compiled with other values."""
    return (
        f"The firmware {'.'.join(map(str, hello.version))} has contract {hello.contract:08x}, this program has "
        f"{wire.CONTRACT:08x}: the firmware is of another version, or was built for another robot (microsteps, gears, "
        "guard, speed). End the programs that use the board and run `beatrix flash`, which installs this program's "
        "firmware. If you need the other firmware, use the program that was generated with it."
    )
