"""A simulated Mega behind a pseudo-terminal, in real time.

python tests/avr/live.py --path /tmp/board    then  python -m hw_node --name bea --port /tmp/board
The line `reset` on standard input presses the reset button, as opening a real port does, and is then printed. The end
of standard input ends the program.
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

CYCLES_PER_S: Final = 1000 * CYCLES_PER_MS
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


def run(avr: Avr, master: int) -> None:
    """Run the board in real time until the end of standard input."""
    ctypes.CDLL(None).prctl(PR_SET_TIMERSLACK, 1)  # otherwise each slice ends 0.05 ms late
    next_s = time.monotonic()
    began_s, last_input_s = next_s - avr.cycle / CYCLES_PER_S, 0.0
    while True:
        now_s = time.monotonic()
        active = now_s - last_input_s < ACTIVE_S
        next_s = max(next_s + (ACTIVE_SLICE_S if active else SLICE_S), now_s)
        ready, _, _ = select.select([sys.stdin, master], [], [], max(0.0, next_s - time.monotonic()))
        if sys.stdin in ready:
            data = os.read(sys.stdin.fileno(), 4096)
            if not data:
                return
            for word in data.decode().split():
                if word == "reset":
                    avr.reset()
                print(word, flush=True)
            continue
        behind_s = time.monotonic() - began_s - avr.cycle / CYCLES_PER_S
        if behind_s > STALL_S:
            began_s += behind_s
        due = round((time.monotonic() - began_s) * CYCLES_PER_S)
        avr.run_until(min(due, avr.cycle + CATCH_UP))
        if data := avr.receive():
            # If no program reads, the buffer becomes full. Bytes are lost then, as in the buffer of a real chip.
            with contextlib.suppress(BlockingIOError):
                os.write(master, data)
        if ready:
            avr.send(os.read(master, 4096))
            last_input_s = time.monotonic()


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--path", type=Path, required=True, help="path of the symbolic link to the port")
    parser.add_argument("--firmware", type=Path, default=HEX, help=".hex or .elf")
    given = parser.parse_args()
    master, slave = os.openpty()  # the slave stays open, because programs open and close the port
    tty.setraw(slave)
    os.set_blocking(master, False)
    given.path.unlink(missing_ok=True)
    given.path.symlink_to(os.ttyname(slave))
    print(f"ready: {given.path}", flush=True)
    try:
        with Avr(given.firmware) as avr:
            run(avr, master)
    except KeyboardInterrupt:
        pass
    finally:
        given.path.unlink(missing_ok=True)


if __name__ == "__main__":
    main()
