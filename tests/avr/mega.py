"""The simulated Mega as a Rig or a Core, and the checks of its pins."""

from __future__ import annotations

from pathlib import Path
from typing import Final, Self

import numpy as np
from avr.bench import EEPROM_SIZE, SIGNALS, Avr
from firmware_host import ROOT, Rig, Steps

from beatrix_zenoh.board.link import Decoder

HEX: Final = ROOT / "hw_node/beatrix-mega2560.hex"
"""The hex file for real boards."""
LOADER: Final = Path(
    "/usr/share/arduino/hardware/arduino/avr/bootloaders/stk500v2/stk500boot_v2_mega2560.hex"
)
"""The Mega's boot loader, from Debian's arduino-core-avr."""
START_MS: Final = 30
"""Time (ms) from reset to the end of HELLO: the board first stores the boot number, which takes 3.4 ms a byte."""
PULSE_MIN: Final = 16
"""Shortest pulse and shortest pause (cycles): 1 us (A4988)."""
SETUP_MIN: Final = 4
"""Shortest time (cycles) between a change of direction and a step, before and after: over 200 ns (A4988)."""


class MegaCore:
    """The Mega as a Core for Rig: replies are sent when `receive` returns."""

    def __init__(self, avr: Avr) -> None:
        self.avr = avr

    def receive(self, data: bytes) -> None:
        """Send bytes to the board and run for 4 ms, in which it replies."""
        self.avr.deliver(data)
        self.avr.run_ms(4)

    def transmit(self) -> bytes:
        """Return all bytes that the board has sent since the last call."""
        return self.avr.receive()

    def tick(self, ms: int) -> None:
        """Let this many milliseconds pass."""
        self.avr.run_ms(ms)

    def steps(self) -> Steps:
        """Return the position of each arm, counted from the steps on the pins."""
        return self.avr.pulses()


class Checked:
    """A board to use in `with`, which checks its pins and its serial line if the test has passed, and frees it."""

    avr: Avr

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *rest: object) -> None:
        try:
            if kind is None:
                assert pin_faults(self.avr) == []
                assert self.avr.overruns == 0
        finally:
            self.avr.close()


class MegaPort(Checked, MegaCore):
    """The Mega as a Core for Program: `receive` queues bytes and does not wait."""

    def __init__(self, firmware: Path = HEX, baud: int = 250_000) -> None:
        super().__init__(Avr(firmware, baud=baud))
        self.avr.run_ms(START_MS)

    def receive(self, data: bytes) -> None:
        """Queue bytes on the serial line."""
        self.avr.send(data)


class Mega(Checked, Rig):
    """Rig on the Mega."""

    def __init__(self, firmware: Path = HEX, eeprom: bytes = b"\xff" * EEPROM_SIZE) -> None:
        self.avr = Avr(firmware, eeprom)
        self.avr.run_ms(START_MS)
        super().__init__(MegaCore(self.avr))

    def restart(self, after_cycles: int = 0) -> None:
        """Press reset after this number of cycles; return when the board has started."""
        self.avr.run(after_cycles)
        self.avr.reset()
        self.discard_interrupted_frame()
        self.tick(START_MS)

    def discard_interrupted_frame(self) -> None:
        """Discard the frame that a reset has interrupted."""
        self.core.transmit()
        self._decoder = Decoder()
        self.others.clear()

    def settle(self) -> None:
        """Run for 20 ms, in which the planned steps are made and reported."""
        self.tick(20)


def pin_faults(avr: Avr) -> list[str]:
    """Return messages about pulses that violate the timing of the drivers, and steps while they are off."""
    edges = avr.all_edges()
    enables = avr.edges("enable")
    levels = np.concatenate([[1], enables["level"]])  # high before its first change: the drivers are off
    found = []
    for arm in range(3):
        wire = edges[edges["signal"] == arm]["cycle"].astype(np.int64)
        steps = wire[0::2]
        if len(wire) and np.diff(wire).min(initial=PULSE_MIN) < PULSE_MIN:
            found.append(f"arm {arm}: a pulse or pause of {np.diff(wire).min()} cycles")
        turns = edges[edges["signal"] == 3 + arm]["cycle"].astype(np.int64)
        if len(steps) and len(turns):
            after = np.searchsorted(steps, turns)
            ahead = steps[np.minimum(after, len(steps) - 1)] - turns
            if ((ahead >= 0) & (ahead < SETUP_MIN)).any():
                found.append(f"arm {arm}: {SIGNALS[1]} set less than 200 ns before a step")
            behind = turns - steps[np.maximum(after - 1, 0)]
            if ((behind >= 0) & (behind < SETUP_MIN)).any():
                found.append(f"arm {arm}: {SIGNALS[1]} changed less than 200 ns after a step")
        at = np.searchsorted(enables["cycle"].astype(np.int64), steps, side="right")
        if (levels[at] == 1).any():
            found.append(f"arm {arm}: a step while the drivers are off")
    return found
