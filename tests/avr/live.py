"""A simulated Mega behind a pseudo-terminal, in real time.

python tests/avr/live.py --path /tmp/board    then  python -m hw_node --name bea --port /tmp/board
Lines on standard input work it, and are repeated when done:
  reset         the button, or what opening a real port does
  freeze, go    the processor stands still, and goes on
  unplug, plug  the cable, and with it the power: the port is gone, then a new one is there
  noise, quiet  one byte in a hundred is another, both ways
  swallow       the next answer to a numbered request gets lost
  quit
It ends with its standard input, and says how well it has kept time.
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

from avr.bench import CYCLES_PER_MS, EEPROM_SIZE, Avr
from avr.mega import HEX

from beatrix_zenoh._generated.serial import BAUD, FrameType
from beatrix_zenoh.board.link import Decoder

SLICE_S: Final = 0.001
"""What the board says of itself waits so long at most; what it hears goes onto its wire at once."""
ASKED_SLICE_S, ASKED_S = 10 / BAUD, 0.005
"""The same, one byte's time, for so long after it was spoken to: it is about to answer."""
CATCH_UP: Final = 20 * CYCLES_PER_MS
"""Cycles in one go after this process has had to wait: control lines still get through."""
SPOILT: Final = 0.01
PR_SET_TIMERSLACK: Final = 29
"""linux/prctl.h; ns."""
WORDS: Final = ("reset", "freeze", "go", "unplug", "plug", "noise", "quiet", "swallow", "quit")


class Cable:
    """A pseudo-terminal whose link comes and goes, with what can happen to bytes on their way."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.master, self._slave = os.openpty()  # the other end stays open: programs come and go
        tty.setraw(self._slave)
        os.set_blocking(self.master, False)
        path.unlink(missing_ok=True)
        path.symlink_to(os.ttyname(self._slave))
        self._chance = random.Random(1)
        self._begun = b""
        self.noisy = self.swallowing = False

    def take(self) -> bytes:
        """What programs have sent; something must have come."""
        return self._spoilt(os.read(self.master, 4096))

    def give(self, said: bytes) -> None:
        """Send bytes to the program that has the port open."""
        if self.swallowing:
            said = self._without_an_answer(said)
        with contextlib.suppress(BlockingIOError):  # without a reader; a real chip's buffer overflows as well
            os.write(self.master, self._spoilt(said))

    def _spoilt(self, data: bytes) -> bytes:
        if not self.noisy:
            return data
        chance = self._chance
        return bytes(chance.randrange(256) if chance.random() < SPOILT else byte for byte in data)

    def _without_an_answer(self, said: bytes) -> bytes:
        """Whole frames, but for the first that answers a request with a number."""
        *frames, self._begun = (self._begun + said).split(b"\0")
        for at, frame in enumerate(frames):
            for heard in Decoder().feed(frame + b"\0"):
                if FrameType.ACK <= heard.type < FrameType.TELEMETRY and heard.seq:
                    self.swallowing = False
                    rest, self._begun = self._begun, b""
                    return b"".join(kept + b"\0" for kept in frames[:at] + frames[at + 1 :]) + rest
        return b"".join(frame + b"\0" for frame in frames)

    def close(self) -> None:
        """Pull it out."""
        self._path.unlink(missing_ok=True)
        os.close(self.master)
        os.close(self._slave)


class Live:
    """The board, its pseudo-terminal, and real time."""

    def __init__(self, firmware: Path, path: Path) -> None:
        self._firmware, self._path = firmware, path
        self._frozen = False
        self._running = True
        self._half_line = b""
        self._heard_s = 0.0
        self._lags: list[float] = []
        self._memory = b"\xff" * EEPROM_SIZE
        self._plug()

    # -- words ----------------------------------------------------------------------------------

    def _plug(self) -> None:
        """Power comes, and a port."""
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

    # -- life -----------------------------------------------------------------------------------

    def run(self) -> None:
        """Run until the control line `quit`."""
        ctypes.CDLL(None).prctl(PR_SET_TIMERSLACK, 1)  # otherwise each slice ends 0.05 ms late
        next_s = time.monotonic()
        while self._running:
            now = time.monotonic()
            asked = now - self._heard_s < ASKED_S
            next_s = max(next_s + (ASKED_SLICE_S if asked else SLICE_S), now)
            wires = [sys.stdin] if self._frozen else [sys.stdin, self._cable.master]
            ready, _, _ = select.select(wires, [], [], max(0.0, next_s - time.monotonic()))
            if sys.stdin in ready:
                self._listen(os.read(sys.stdin.fileno(), 4096))
            elif not self._frozen:
                self._live(heard=bool(ready))

    def _live(self, *, heard: bool) -> None:
        """Time up to now, what the board has said in it, what programs have sent just now."""
        due = round((time.monotonic() - self._began) * 1000 * CYCLES_PER_MS)
        self._avr.run_until(min(due, self._avr.cycle + CATCH_UP))
        self._lags.append(time.monotonic() - self._began - self._avr.cycle / (1000 * CYCLES_PER_MS))
        if said := self._avr.receive():
            self._cable.give(said)
        if heard:
            self._avr.send(self._cable.take())
            self._heard_s = time.monotonic()

    def _listen(self, heard: bytes) -> None:
        if not heard:
            self._running = False
        *lines, self._half_line = (self._half_line + heard).split(b"\n")
        for line in lines:
            self._obey(line.decode(errors="replace").strip())

    def _obey(self, word: str) -> None:
        if word not in WORDS:
            print(f"what is {word!r}? Say one of: {', '.join(WORDS)}", flush=True)
            return
        if self._plugged == (word == "plug") and word != "quit":
            print(f"{word}: it is {'plugged in' if self._plugged else 'unplugged'}", flush=True)
            return
        getattr(self, f"_{word}")()
        print(word, flush=True)

    def close(self) -> None:
        """Disappear, and say how far the board was behind real time after every slice."""
        if self._plugged:
            self._unplug()
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
