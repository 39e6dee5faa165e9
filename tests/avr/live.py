"""A simulated Mega behind a pseudo-terminal, in real time: plug a program in where a board would be.

python tests/avr/live.py --path /tmp/board    then  python -m hw_node --name bea --port /tmp/board
Lines on standard input work it: reset (the button, or what opening a real port does), freeze, go, quit.
It ends with its standard input, and says how well it has kept time.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import select
import sys
import time
import tty
from pathlib import Path
from typing import Final

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from avr.bench import CYCLES_PER_MS, Avr
from avr.mega import HEX

SLICE_S: Final = 0.001
"""Bytes wait so long at most, in either direction."""
CATCH_UP: Final = 20 * CYCLES_PER_MS
"""Cycles in one go after this process has had to wait: control lines still get through."""
WORDS: Final = ("reset", "freeze", "go", "quit")


class Live:
    """The board, its pseudo-terminal, and real time."""

    def __init__(self, firmware: Path, path: Path) -> None:
        self._avr = Avr(firmware)
        self._path = path
        self._master, self._slave = os.openpty()  # the other end stays open: programs come and go
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        path.unlink(missing_ok=True)
        path.symlink_to(os.ttyname(self._slave))
        self._frozen = False
        self._running = True
        self._half_line = b""
        self._began = time.monotonic()
        self._lags: list[float] = []

    def run(self) -> None:
        """Until it is told to quit."""
        next_s = time.monotonic()
        while self._running:
            next_s = max(next_s + SLICE_S, time.monotonic())
            ready, _, _ = select.select([sys.stdin], [], [], max(0.0, next_s - time.monotonic()))
            if ready:
                self._listen(os.read(sys.stdin.fileno(), 4096))
            elif not self._frozen:
                self._live()

    def _live(self) -> None:
        """One slice: what programs have sent, time, what the board has sent."""
        with contextlib.suppress(BlockingIOError):
            self._avr.send(os.read(self._master, 4096))
        due = round((time.monotonic() - self._began) * 1000 * CYCLES_PER_MS)
        self._avr.run_until(min(due, self._avr.cycle + CATCH_UP))
        self._lags.append(time.monotonic() - self._began - self._avr.cycle / (1000 * CYCLES_PER_MS))
        if said := self._avr.receive():
            with contextlib.suppress(BlockingIOError):  # nobody reads: a real chip's buffer overflows as well
                os.write(self._master, said)

    def _listen(self, heard: bytes) -> None:
        if not heard:
            self._running = False
        *lines, self._half_line = (self._half_line + heard).split(b"\n")
        for line in lines:
            self._obey(line.decode(errors="replace").strip())

    def _obey(self, word: str) -> None:
        match word:
            case "reset":
                self._avr.reset()
            case "freeze":
                self._frozen = True
            case "go":
                self._frozen = False
                self._began = time.monotonic() - self._avr.cycle / (1000 * CYCLES_PER_MS)
            case "quit":
                self._running = False
            case _:
                print(f"what is {word!r}? Say one of: {', '.join(WORDS)}", flush=True)

    def close(self) -> None:
        """Disappear, and say how far the board was behind real time after every slice."""
        self._path.unlink(missing_ok=True)
        self._avr.close()
        os.close(self._master)
        os.close(self._slave)
        lags = sorted(self._lags) or [0.0]
        late = (f"{1000 * lags[int(part * (len(lags) - 1))]:.2f}" for part in (0.5, 0.99, 0.999, 1.0))
        print(f"behind real time: median, p99, p99.9, worst [ms]: {', '.join(late)}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--path", type=Path, required=True, help="where the port's link shall be")
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
