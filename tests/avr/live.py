"""A simulated Mega behind a pseudo-terminal, in real time.

python tests/avr/live.py --path /tmp/board    then  python -m hw_node --name bea --port /tmp/board
Each line on standard input is a command, and is printed again after it has been carried out:
reset  press the reset button, as opening a real port does
quit   end the program, as the end of standard input does
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import os
import select
import sys
import time
import tty
from pathlib import Path
from typing import Final

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

from avr.bench import CYCLES_PER_MS, Avr
from avr.mega import HEX

from beatrix_zenoh.contract._generated.serial import BAUD

SLICE_S: Final = 0.001
"""Longest delay of bytes from the board (s); bytes to the board are passed on at once."""
ACTIVE_SLICE_S, ACTIVE_S = 10 / BAUD, 0.005
"""Longest delay (s), the time of one byte, while a reply is expected; and how long (s) after an input it applies."""
CATCH_UP: Final = 20 * CYCLES_PER_MS
"""Largest number of cycles in one step after a delay of this process; commands are read between steps."""
STALL_S: Final = 0.3
"""Longest delay to catch up with. A longer one is skipped, as on a virtual board: the node was delayed as well, so the
board would miss a heartbeat that no real board misses."""
PR_SET_TIMERSLACK: Final = 29
"""Option of prctl(2) that sets the timer slack (ns)."""
WORDS: Final = ("reset", "quit")


class Cable:
    """The pseudo-terminal of the board."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.master, self._slave = (
            os.openpty()
        )  # keep the other end open, because programs open and close the port
        tty.setraw(self._slave)
        os.set_blocking(self.master, False)
        path.unlink(missing_ok=True)
        path.symlink_to(os.ttyname(self._slave))

    def take(self) -> bytes:
        """Return the bytes that programs have sent; blocks if there are none."""
        return os.read(self.master, 4096)

    def give(self, data: bytes) -> None:
        """Send bytes to the program that has the port open."""
        # If no program reads, the buffer becomes full. Bytes are lost then, as in the buffer of a real chip.
        with contextlib.suppress(BlockingIOError):
            os.write(self.master, data)

    def close(self) -> None:
        """Remove the port."""
        self._path.unlink(missing_ok=True)
        os.close(self.master)
        os.close(self._slave)


class Live:
    """Runs the board in real time, behind its pseudo-terminal."""

    def __init__(self, firmware: Path, path: Path) -> None:
        self._running = True
        self._half_line = b""
        self._last_input_s = 0.0
        self._avr = Avr(firmware)
        self._cable = Cable(path)
        self._began = time.monotonic() - self._avr.cycle / (1000 * CYCLES_PER_MS)

    def _reset(self) -> None:
        self._avr.reset()

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
            ready, _, _ = select.select(
                [sys.stdin, self._cable.master], [], [], max(0.0, next_s - time.monotonic())
            )
            if sys.stdin in ready:
                self._listen(os.read(sys.stdin.fileno(), 4096))
            else:
                self._run_to_now(has_input=bool(ready))

    def _run_to_now(self, *, has_input: bool) -> None:
        """Run the board up to now; pass its bytes to programs, and those of programs to the board."""
        if (behind_s := self._behind_s()) > STALL_S:
            self._began += behind_s
        due = round((time.monotonic() - self._began) * 1000 * CYCLES_PER_MS)
        self._avr.run_until(min(due, self._avr.cycle + CATCH_UP))
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
        getattr(self, f"_{word}")()
        print(word, flush=True)

    def close(self) -> None:
        """Remove the port and end the simulation."""
        self._cable.close()
        self._avr.close()


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
