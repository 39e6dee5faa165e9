"""A simulated Mega behind a pseudo-terminal, in real time.

python tests/avr/live.py --path /tmp/board    then  python -m hw_node --name bea --port /tmp/board
Each line on standard input is a command, and is printed again after it has been carried out:
reset         press the reset button, as opening a real port does
freeze, go    suspend the processor, and let it continue
unplug, plug  pull the cable, which also cuts the power and removes the port; plug it in again
noise, quiet  start or stop damaging one byte in a hundred, in both directions
swallow       lose the next reply to a numbered request
quit          end the program
The program also ends when its standard input ends. Then it prints its delays behind real time.
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import os
import random
import select
import sys
import time
import tty
from pathlib import Path
from typing import Final

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

from avr.bench import CYCLES_PER_MS, EEPROM_SIZE, Avr
from avr.mega import HEX

from beatrix_zenoh.board.link import Decoder
from beatrix_zenoh.contract._generated.serial import BAUD, FrameType

SLICE_S: Final = 0.001
"""Longest delay of bytes from the board (s); bytes to the board are passed on at once."""
ACTIVE_SLICE_S, ACTIVE_S = 10 / BAUD, 0.005
"""Longest delay (s), the time of one byte, while a reply is expected; and how long (s) after an input it applies."""
CATCH_UP: Final = 20 * CYCLES_PER_MS
"""Largest number of cycles in one step after a delay of this process; commands are read between steps."""
STALL_S: Final = 0.3
"""Longest delay to catch up with. A longer one is skipped, as on a virtual board: the node was delayed as well, so the
board would miss a heartbeat that no real board misses."""
DAMAGED_SHARE: Final = 0.01
"""Share of damaged bytes while there is noise."""
PR_SET_TIMERSLACK: Final = 29
"""Option of prctl(2) that sets the timer slack (ns)."""
WORDS: Final = ("reset", "freeze", "go", "unplug", "plug", "noise", "quiet", "swallow", "quit")


class Cable:
    """A pseudo-terminal that can be plugged and unplugged, and that can damage or lose bytes."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.master, self._slave = (
            os.openpty()
        )  # keep the other end open, because programs open and close the port
        tty.setraw(self._slave)
        os.set_blocking(self.master, False)
        path.unlink(missing_ok=True)
        path.symlink_to(os.ttyname(self._slave))
        self._chance = random.Random(1)
        self._begun = b""
        self.noisy = self.swallowing = False

    def take(self) -> bytes:
        """Return the bytes that programs have sent; blocks if there are none."""
        return self._damaged(os.read(self.master, 4096))

    def give(self, data: bytes) -> None:
        """Send bytes to the program that has the port open."""
        if self.swallowing:
            data = self._without_one_reply(data)
        # If no program reads, the buffer becomes full. Bytes are lost then, as in the buffer of a real chip.
        with contextlib.suppress(BlockingIOError):
            os.write(self.master, self._damaged(data))

    def _damaged(self, data: bytes) -> bytes:
        if not self.noisy:
            return data
        chance = self._chance
        return bytes(chance.randrange(256) if chance.random() < DAMAGED_SHARE else byte for byte in data)

    def _without_one_reply(self, data: bytes) -> bytes:
        """Return the complete frames without the first reply to a numbered request."""
        *frames, self._begun = (self._begun + data).split(b"\0")
        for at, frame in enumerate(frames):
            for decoded in Decoder().feed(frame + b"\0"):
                if FrameType.ACK <= decoded.type < FrameType.TELEMETRY and decoded.seq:
                    self.swallowing = False
                    rest, self._begun = self._begun, b""
                    return b"".join(kept + b"\0" for kept in frames[:at] + frames[at + 1 :]) + rest
        return b"".join(frame + b"\0" for frame in frames)

    def close(self) -> None:
        """Remove the port, as if the cable were pulled out."""
        self._path.unlink(missing_ok=True)
        os.close(self.master)
        os.close(self._slave)


class Live:
    """Runs the board in real time, behind its pseudo-terminal."""

    def __init__(self, firmware: Path, path: Path) -> None:
        self._firmware, self._path = firmware, path
        self._frozen = False
        self._running = True
        self._half_line = b""
        self._last_input_s = 0.0
        self._lags: list[float] = []
        self._memory = b"\xff" * EEPROM_SIZE
        self._plug()

    # -- commands -------------------------------------------------------------------------------

    def _plug(self) -> None:
        """Switch the board on and create its port."""
        self._avr = Avr(self._firmware, self._memory)
        self._cable = Cable(self._path)
        self._plugged = True
        self._go()

    def _unplug(self) -> None:
        self._frozen, self._plugged = True, False
        self._memory = self._avr.eeprom
        self._avr.close()
        self._cable.close()

    def _reset(self) -> None:
        self._avr.reset()

    def _freeze(self) -> None:
        self._frozen = True

    def _go(self) -> None:
        self._frozen = False
        self._began = time.monotonic() - self._avr.cycle / (1000 * CYCLES_PER_MS)

    def _noise(self) -> None:
        self._cable.noisy = True

    def _quiet(self) -> None:
        self._cable.noisy = False

    def _swallow(self) -> None:
        self._cable.swallowing = True

    def _quit(self) -> None:
        self._running = False

    # -- running --------------------------------------------------------------------------------

    def run(self) -> None:
        """Run until the command `quit` or the end of standard input."""
        ctypes.CDLL(None).prctl(PR_SET_TIMERSLACK, 1)  # otherwise each slice ends 0.05 ms late
        next_s = time.monotonic()
        while self._running:
            now = time.monotonic()
            active = now - self._last_input_s < ACTIVE_S
            next_s = max(next_s + (ACTIVE_SLICE_S if active else SLICE_S), now)
            wires = [sys.stdin] if self._frozen else [sys.stdin, self._cable.master]
            ready, _, _ = select.select(wires, [], [], max(0.0, next_s - time.monotonic()))
            if sys.stdin in ready:
                self._listen(os.read(sys.stdin.fileno(), 4096))
            elif not self._frozen:
                self._run_to_now(has_input=bool(ready))

    def _run_to_now(self, *, has_input: bool) -> None:
        """Run the board up to now; pass its bytes to programs, and those of programs to the board."""
        if (behind_s := self._behind_s()) > STALL_S:
            self._lags.append(behind_s)
            self._began += behind_s
        due = round((time.monotonic() - self._began) * 1000 * CYCLES_PER_MS)
        self._avr.run_until(min(due, self._avr.cycle + CATCH_UP))
        self._lags.append(self._behind_s())
        if data := self._avr.receive():
            self._cable.give(data)
        if has_input:
            self._avr.send(self._cable.take())
            self._last_input_s = time.monotonic()

    def _behind_s(self) -> float:
        """Return how far (s) the board is behind real time."""
        return time.monotonic() - self._began - self._avr.cycle / (1000 * CYCLES_PER_MS)

    def _listen(self, data: bytes) -> None:
        if not data:
            self._running = False
        *lines, self._half_line = (self._half_line + data).split(b"\n")
        for line in lines:
            self._carry_out(line.decode(errors="replace").strip())

    def _carry_out(self, word: str) -> None:
        if word not in WORDS:
            print(f"There is no command {word!r}. Type one of: {', '.join(WORDS)}", flush=True)
            return
        if self._plugged == (word == "plug") and word != "quit":
            state = "already plugged in." if self._plugged else "unplugged. Type plug first."
            print(f"{word}: the board is {state}", flush=True)
            return
        getattr(self, f"_{word}")()
        print(word, flush=True)

    def close(self) -> None:
        """Unplug the board, and print percentiles of its delays behind real time."""
        if self._plugged:
            self._unplug()
        lags = sorted(self._lags) or [0.0]
        late = (f"{1000 * lags[int(part * (len(lags) - 1))]:.2f}" for part in (0.5, 0.99, 0.999, 1.0))
        print(f"behind real time: median, p99, p99.9, worst [ms]: {', '.join(late)}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--path", type=Path, required=True, help="path of the symbolic link to the port")
    parser.add_argument("--firmware", type=Path, default=HEX, help=".hex or .elf")
    given = parser.parse_args()
    live = Live(given.firmware, given.path)
    print(f"ready: {given.path}", flush=True)
    try:
        live.run()
    except KeyboardInterrupt:
        pass
    finally:
        live.close()


if __name__ == "__main__":
    main()
