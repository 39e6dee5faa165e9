"""Print what the Mega's firmware does on its pins and its wire, in virtual time on libsimavr: exact cycles.

The shipped hex file, and beside it the same sources for a robot whose limits allow what the processor can do.
"""

from __future__ import annotations

import random
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

ROOT: Final = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))

from avr.bench import CYCLES_PER_MS, VECTORS  # noqa: E402 - the bench belongs to the tests
from avr.mega import HEX, Mega  # noqa: E402
from rig import Steps  # noqa: E402

from beatrix_zenoh._generated.serial import TELEMETRY_PERIOD, FrameType, Move, MoveStraight  # noqa: E402
from beatrix_zenoh.board.link import Decoder, encode  # noqa: E402

CYCLES_PER_S: Final = 16_000_000
BUDGET: Final = {"step x": 300, "step y": 300, "step z": 300, "receive": 100, "transmit": 100, "tick": 8000}
"""Cycles, as firmware/core/hal.h grants them; of a step's half may be waiting for its very cycle."""
EVEN: Final = {(800, 800, 800): 2, (800, 560, 240): 2, (4189, 4189, 4189): 2, (4189, 3000, 1000): None}
"""Quarter microsteps per second of the arms, and what their periods may be off by, in cycles: nothing is asked where
arms that do not go alike meet too often for one never to hold up another."""
EVEN_MS: Final = 1600
FAST: Final = "[drive]\nmicrosteps = 32\n[limits]\nspeed_max = 313.0\nacceleration = 1500.0\n"
"""What the fast robot has otherwise than schemas/robot.toml: arms at 14 500 steps/s."""
PHASES: Final = 25
FLOOD_MS: Final = 500
LATER: Final = 8
"""Cycles: more than two lives differ by in which interrupts meet otherwise."""

T = TypeVar("T")


@dataclass
class Seen:
    """What holds for all runs together."""

    pulse: int = 1 << 30
    setup: int = 1 << 30
    powerless: int = 0
    inexact: int = 0
    runs: int = 0
    longest: dict[str, int] = field(default_factory=dict)

    def add(self, mega: Mega) -> None:
        """Look at a board whose motions are over."""
        self.runs += 1
        self.inexact += mega.last.position != mega.steps
        enables = mega.avr.edges("enable")
        for arm in range(3):
            step = mega.avr.edges("step", arm)["cycle"].astype(np.int64)
            self.pulse = min(self.pulse, int(np.diff(step).min(initial=self.pulse)))
            turns = mega.avr.edges("direction", arm)["cycle"].astype(np.int64)
            rises = step[0::2]
            after = np.searchsorted(rises, turns)
            ahead = rises[after[after < len(rises)]] - turns[after < len(rises)]
            self.setup = min(self.setup, int(ahead.min(initial=self.setup)))
            at = np.searchsorted(enables["cycle"].astype(np.int64), rises, side="right")
            self.powerless += int(np.concatenate([[1], enables["level"]])[at].sum())
        for vector, name in VECTORS.items():
            self.longest[name] = max(self.longest.get(name, 0), mega.avr.work(vector).longest)


@dataclass(frozen=True)
class Robot:
    """A firmware, and where and how fast its arms may go together."""

    name: str
    firmware: Path
    far: int
    top: Steps

    def cruise(self, mega: Mega) -> None:
        """All three arms at top speed, since 0.2 s and for 0.2 s more at least."""
        mega.ready()
        mega.move((-self.far,) * 3, self.top)
        mega.run()
        mega.move((self.far,) * 3, self.top)
        wait(mega, 800)

    def finish(self, mega: Mega, seen: Seen) -> None:
        """To the end of the motion."""
        mega.tick(5)  # answers that are still to come
        mega.run()
        mega.settle()
        seen.add(mega)


def wait(mega: Mega, ms: int) -> None:
    """Let time pass, with heartbeats."""
    for _ in range(ms // 20):
        mega.ask(FrameType.PING)
        mega.tick(16)


def periods(mega: Mega, arm: int, last: int) -> NDArray[np.int64]:
    """Cycles between an arm's latest steps."""
    found: NDArray[np.int64] = np.diff(mega.avr.steps(arm)[0][-last - 1 :])
    return found


def make(source: str, *settings: str, build: Path) -> str:
    """Make firmware/Makefile's `mega` in a folder; what make has said."""
    command = ["make", "-C", str(ROOT / "firmware"), "mega", f"BUILD={build}", f"PYTHON={sys.executable}"]
    done = subprocess.run([*command, *settings], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{source} cannot be built (apt-get install gcc-avr avr-libc):\n{done.stderr}")
    return done.stdout


def fast_robot(folder: Path) -> Robot:
    """The firmware for arms that may go as fast as the processor."""
    (folder / "fast.toml").write_text(FAST, encoding="utf-8")
    firmware = folder / "fast.hex"
    make("the fast robot's firmware", f"ROBOT={folder / 'fast.toml'}", f"HEX={firmware}", build=folder)
    return Robot("14 500 steps/s", firmware, 9000, (58_200, 57_400, 56_200))


def show(figure: str, measured: str, to_reach: str = "", *, good: bool = True) -> None:
    """One row; what falls short says so."""
    wanted = f"to reach: {to_reach}" if to_reach else ""
    print(f"{figure:64} {measured:32} {wanted:24} {'' if good else 'FALLS SHORT'}".rstrip())


def periods_off(robot: Robot, speeds: Steps, seen: Seen) -> NDArray[np.float64]:
    """How far the periods of arms at these speeds are from their arm's mean, in cycles."""
    with Mega(robot.firmware) as mega:
        mega.ready()
        mega.move((2000, 2000, 2000), speeds)
        wait(mega, EVEN_MS)
        off = []
        for arm, speed in enumerate(speeds):
            gone = periods(mega, arm, speed // 4)  # of the last second: it was at speed before
            off.append(gone - gone.mean())
        mega.ask(FrameType.STOP)
        robot.finish(mega, seen)
    return np.concatenate(off)


def even_steps(robots: list[Robot], seen: Seen) -> None:
    """How evenly steps come, and telemetry beside them."""
    shipped, fast = robots
    for speeds, most in EVEN.items():
        off = periods_off(shipped, speeds, seen)
        worst = np.abs(off).max()
        show(
            f"{'/'.join(f'{speed / 4:.0f}' for speed in speeds)} steps/s: periods off by [cycles]",
            f"{worst:.0f}, sd {off.std():.1f}, {100 * (np.abs(off) <= 2).mean():.1f} % within 2",
            f"{most or ''}",
            good=most is None or worst <= most,
        )
    with Mega(fast.firmware) as mega:
        fast.cruise(mega)
        for arm in range(3):
            gone = periods(mega, arm, 4000)
            rate, sd = CYCLES_PER_S / gone.mean(), gone.std()
            figures = f"{rate:.0f}, sd {sd:.1f}, {gone.min()}..{gone.max()}"
            show(
                f"three arms together, arm {arm} [steps/s; cycles]",
                figures,
                "14000, sd 40",
                good=rate >= 14_000 and sd <= 40,
            )
        slept, began = mega.avr.slept, mega.avr.cycle
        mega.tick(50)
        load = 1 - (mega.avr.slept - slept) / (mega.avr.cycle - began)
        show("the same: processor busy [%]", f"{100 * load:.0f}")
        fast.finish(mega, seen)
        gaps = {b.tick - a.tick for a, b in pairwise(mega.telemetry) if a.state == b.state == 7}
        show("the same: telemetry every [ms]", f"{sorted(gaps)}", "[10]", good=gaps == {10})


def at_phases(robot: Robot, seen: Seen, measure: Callable[[Mega], T], within_ms: int = 1) -> list[T]:
    """A figure at full speed, at moments that lie anywhere between two ticks, or in more: the same in every call."""
    chance = random.Random(1)
    found = []
    for _ in range(PHASES * within_ms):
        with Mega(robot.firmware) as mega:
            robot.cruise(mega)
            mega.avr.run(chance.randrange(within_ms * CYCLES_PER_MS))
            found.append(measure(mega))
            robot.finish(mega, seen)
    return found


def stop(robot: Robot, seen: Seen) -> None:
    """How soon STOP shows: at the first step that comes later than it does in the same life with a PING instead."""

    def after(kind: FrameType) -> Callable[[Mega], tuple[int, NDArray[np.int64]]]:
        def measure(mega: Mega) -> tuple[int, NDArray[np.int64]]:
            came = mega.avr.send(encode(kind, 1, b""))
            mega.avr.run_ms(20)
            return came, mega.avr.steps(0)[0]

        return measure

    took = []
    stopped, pinged = (at_phases(robot, seen, after(kind)) for kind in (FrameType.STOP, FrameType.PING))
    for (came, slow), (_, usual) in zip(stopped, pinged, strict=True):
        shared = min(len(slow), len(usual))
        late = slow[:shared][slow[:shared] > usual[:shared] + LATER]
        took.append((int(late[0]) - came) / CYCLES_PER_MS)
    show(f"{robot.name}: STOP to first slower step, worst [ms]", f"{max(took):.2f}", "3", good=max(took) <= 3)


def off_after_emergency(mega: Mega) -> float:
    """From EMERGENCY_STOP's last byte to the enable wire."""
    came = mega.avr.send(encode(FrameType.EMERGENCY_STOP, 1, b""))
    mega.avr.run_ms(5)
    return (float(mega.avr.edges("enable")["cycle"][-1]) - came) / CYCLES_PER_MS


def answer_cycles(mega: Mega, kind: FrameType, payload: bytes) -> tuple[float, float]:
    """From a request's last byte to the stop bits of its acknowledgement's first and last bytes."""
    before = len(mega.avr.sent())
    came = mega.avr.send(encode(kind, 77, payload))
    mega.avr.run_ms(12)
    mega.tick(0)
    decoder = Decoder()
    sent = mega.avr.sent()
    for at in range(max(0, before - 80), len(sent)):
        for frame in decoder.feed(bytes([int(sent["byte"][at])])):
            if (frame.type, frame.seq) == (kind | 0x80, 77):
                first = at - len(encode(frame.type, frame.seq, frame.payload)) + 1
                return float(sent["cycle"][first]) - came, float(sent["cycle"][at]) - came
    raise AssertionError(f"{kind} was not acknowledged")


def turn_round(robot: Robot, seen: Seen, kind: FrameType, payload: bytes) -> None:
    """How soon requests are answered at full speed; the worst come behind a TELEMETRY that has just begun."""

    def last(mega: Mega) -> float:
        return answer_cycles(mega, kind, payload)[1] / CYCLES_PER_MS

    lasts = at_phases(robot, seen, last, TELEMETRY_PERIOD)
    show(
        f"{robot.name}: {kind.name} to its ACK's last byte, median / p95 / worst [ms]",
        f"{np.median(lasts):.2f} / {np.quantile(lasts, 0.95):.2f} / {max(lasts):.2f}",
        "p95 1",
        good=bool(np.quantile(lasts, 0.95) <= 1),
    )


def flood(robot: Robot, seen: Seen) -> None:
    """Two thirds of the wire full of PINGs at full speed."""
    ping = encode(FrameType.PING, 1, b"")
    with Mega(robot.firmware) as mega:
        robot.cruise(mega)
        count = FLOOD_MS * CYCLES_PER_MS // (len(ping) * mega.avr.byte_cycles * 3 // 2)
        mega.tick(0)
        mega.others.clear()
        for _ in range(count):
            mega.avr.send(ping)
            mega.avr.run(len(ping) * mega.avr.byte_cycles * 3 // 2)
        mega.tick(30)
        figures = f"{mega.avr.overruns} lost, {len(mega.others)} of {count} answered"
        show(
            f"{robot.name}: wire two thirds full, bytes lost by the UART",
            figures,
            "0",
            good=mega.avr.overruns == 0 and len(mega.others) == count,
        )
        robot.finish(mega, seen)


def sizes(folder: Path) -> None:
    """Flash and RAM of the shipped firmware."""
    said = make("the firmware", f"HEX={folder / 'shipped.hex'}", build=folder)
    text, data, bss = (int(word) for word in said.split("filename")[-1].split()[:3])
    show("flash, RAM without stack [bytes]", f"{text + data}, {data + bss}", "253952, 8192")
    if (folder / "shipped.hex").read_bytes() != HEX.read_bytes():
        show("the shipped hex file", "is not what the sources make", "the same", good=False)


def main() -> None:
    seen = Seen()
    with tempfile.TemporaryDirectory() as held:
        folder = Path(held)
        robots = [Robot("1047 steps/s", HEX, 900, (4189, 4189, 4189)), fast_robot(folder)]
        even_steps(robots, seen)
        for robot in robots:
            stop(robot, seen)
            off = max(at_phases(robot, seen, off_after_emergency))
            show(
                f"{robot.name}: EMERGENCY_STOP to enable wire, worst [ms]",
                f"{off:.2f}",
                "0.5",
                good=off <= 0.5,
            )
            turn_round(robot, seen, FrameType.PING, b"")
            for move in (MoveStraight(900, (0, 0, 0), robot.top[0]), Move(900, (0, 0, 0), robot.top)):
                turn_round(robot, seen, move.kind, move.pack())
            flood(robot, seen)
        sizes(folder)
    show("shortest pulse or pause [us]", f"{seen.pulse / 16:.2f}", "1", good=seen.pulse >= 16)
    show("shortest time from direction to step [ns]", f"{seen.setup * 62.5:.0f}", "200", good=seen.setup >= 4)
    show("steps without power", f"{seen.powerless}", "0", good=not seen.powerless)
    show(f"runs of {seen.runs} with an inexact position", f"{seen.inexact}", "0", good=not seen.inexact)
    for name, cycles in seen.longest.items():
        show(
            f"longest {name} interrupt [cycles]", f"{cycles}", f"{BUDGET[name]}", good=cycles <= BUDGET[name]
        )


if __name__ == "__main__":
    main()
