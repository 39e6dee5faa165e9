"""Measure the Mega's firmware on its pins and its serial line, to the cycle, in virtual time on libsimavr.

python tools/bench_mega.py           the shipped hex file
python tools/bench_mega.py --sketch  the sketch, compiled as in the Arduino IDE

Each is compared with a build of the same sources for a robot whose limits are as high as the processor allows.
"""

from __future__ import annotations

import argparse
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
sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "tests/support")]

from avr.bench import BUDGETS, CYCLES_PER_MS, VECTORS  # noqa: E402 - the bench belongs to the tests
from avr.mega import HEX, Mega  # noqa: E402
from firmware_host import Steps  # noqa: E402

from beatrix_zenoh.board.link import Decoder, encode  # noqa: E402
from beatrix_zenoh.contract._generated import serial  # noqa: E402
from beatrix_zenoh.contract._generated.serial import TELEMETRY_PERIOD, FrameType, Move, MoveStraight  # noqa: E402

CYCLES_PER_S: Final = 16_000_000
EVEN: Final = {(800, 800, 800): 2, (800, 560, 240): 2, (4189, 4189, 4189): 2, (4189, 3000, 1000): None}
"""Speeds of the arms (quarter microsteps/s), and the allowed error of their step periods (cycles). None means no limit,
because steps of arms with different speeds often coincide and delay each other."""
EVEN_MS: Final = 1600
FAST: Final = "[drive]\nmicrosteps = 32\n[limits]\nspeed_max = 313.0\nacceleration = 1500.0\n"
"""Values of the fast robot that differ from schemas/robot.toml: arms at 14 500 steps/s."""
PHASES: Final = 25
FLOOD_MS: Final = 500
QUIET_MS: Final = 200
"""Time without requests; a board that moves stops after 500 ms."""
LATER: Final = 8
"""A step that is late by more than this (cycles) was delayed by STOP: coincident interrupts delay steps by less."""

T = TypeVar("T")


@dataclass
class Seen:
    """Worst measurements of all runs."""

    pulse: int = 1 << 30
    """shortest pulse or pause of a step pin (cycles)"""
    setup: int = 1 << 30
    """shortest time from a change of direction to the next step (cycles)"""
    powerless: int = 0
    """number of steps while the drivers were off"""
    inexact: int = 0
    """number of runs in which the reported position differed from the steps on the pins"""
    runs: int = 0
    longest: dict[str, int] = field(default_factory=dict)
    """longest run of each interrupt (cycles), by name"""

    def add(self, mega: Mega) -> None:
        """Add the measurements of a board at rest."""
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
    """A firmware, with a goal and speeds that its arms can reach together."""

    name: str
    firmware: Path
    far: int
    """goal of all arms (microsteps from home)"""
    top: Steps
    """speeds of the arms (quarter microsteps/s)"""

    def cruise(self, mega: Mega) -> None:
        """Turn all three arms; return after at least 0.2 s at top speed, at least 0.2 s before they brake."""
        mega.ready()
        mega.move((-self.far,) * 3, self.top)
        mega.run()
        mega.move((self.far,) * 3, self.top)
        wait(mega, 800)

    def finish(self, mega: Mega, seen: Seen) -> None:
        """Run to the end of the motion and add the measurements."""
        mega.tick(5)  # answers may still arrive
        mega.run()
        mega.settle()
        seen.add(mega)


def wait(mega: Mega, ms: int) -> None:
    """Run the firmware for a time (ms), with heartbeats."""
    for _ in range(ms // 20):
        mega.ask(FrameType.PING)
        mega.tick(16)


def periods(mega: Mega, arm: int, last: int) -> NDArray[np.int64]:
    """Return the `last` latest step periods of an arm, in cycles."""
    found: NDArray[np.int64] = np.diff(mega.avr.steps(arm)[0][-last - 1 :])
    return found


def make(target: str, build: Path, *settings: str) -> tuple[Path, str]:
    """Make `mega` or `arduino` of firmware/Makefile in a folder; return the hex file and the output of make."""
    hex_file = build / "beatrix.hex"
    command = ["make", "-C", str(ROOT / "firmware"), target, f"BUILD={build}", f"HEX={hex_file}"]
    command += [f"PYTHON={sys.executable}", *settings]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        packages = "gcc-avr avr-libc binutils-avr arduino-core-avr"
        sys.exit(f"The firmware cannot be built. Try: apt-get install {packages}\n{done.stderr}")
    return build / "beatrix.ino.hex" if target == "arduino" else hex_file, done.stdout


def fast_robot(target: str, folder: Path) -> Robot:
    """Build the firmware for arms that are as fast as the processor allows, and return its robot."""
    folder.mkdir()
    (folder / "fast.toml").write_text(FAST, encoding="utf-8")
    firmware, _ = make(target, folder, f"ROBOT={folder / 'fast.toml'}")
    return Robot("14 500 steps/s", firmware, 9000, (58_200, 57_400, 56_200))


def show(figure: str, measured: str, to_reach: str = "", *, good: bool = True) -> None:
    """Print one row of the table; mark a figure that is worse than required."""
    wanted = f"required: {to_reach}" if to_reach else ""
    print(f"{figure:64} {measured:32} {wanted:24} {'' if good else 'NOT REACHED'}".rstrip())


def periods_off(robot: Robot, speeds: Steps, seen: Seen) -> NDArray[np.float64]:
    """Return the deviations of step periods from the mean period of their arm, in cycles, at these speeds."""
    with Mega(robot.firmware) as mega:
        mega.ready()
        mega.move((2000, 2000, 2000), speeds)
        wait(mega, EVEN_MS)
        off = []
        for arm, speed in enumerate(speeds):
            cycles = periods(mega, arm, speed // 4)  # of the last second, after the arm has reached its speed
            off.append(cycles - cycles.mean())
        mega.ask(FrameType.STOP)
        robot.finish(mega, seen)
    return np.concatenate(off)


def even_steps(robots: list[Robot], seen: Seen) -> None:
    """Print the step periods, and at full speed also the load of the processor and the telemetry period."""
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
            cycles = periods(mega, arm, 4000)
            rate, sd = CYCLES_PER_S / cycles.mean(), cycles.std()
            figures = f"{rate:.0f}, sd {sd:.1f}, {cycles.min()}..{cycles.max()}"
            show(
                f"three arms together, arm {arm} [steps/s; cycles]",
                figures,
                "14000, sd 40",
                good=rate >= 14_000 and sd <= 40,
            )
        slept, began = mega.avr.slept, mega.avr.cycle
        mega.tick(0)
        quiet = len(mega.telemetry)
        mega.tick(QUIET_MS)
        show("three arms together: processor busy [%]", f"{100 * busy(mega, slept, began):.0f}")
        telemetry(mega, quiet)
        fast.finish(mega, seen)


def busy(mega: Mega, slept: int, began: int) -> float:
    """Return the share of the time since cycle `began`, when the processor had slept `slept` cycles, that it worked."""
    return 1 - (mega.avr.slept - slept) / (mega.avr.cycle - began)


def telemetry(mega: Mega, quiet: int) -> None:
    """Print the periods of TELEMETRY in motion; those from number `quiet` on are without requests.

    TELEMETRY that is due while a request is being received waits, so that the answer to the request goes first.
    """
    longest = TELEMETRY_PERIOD + serial.TELEMETRY_PATIENCE
    for name, rows, most in (
        ("with", mega.telemetry[:quiet], longest),
        ("without", mega.telemetry[quiet:], TELEMETRY_PERIOD),
    ):
        gaps = {b.tick - a.tick for a, b in pairwise(rows) if a.state == b.state == 7}
        show(
            f"three arms together: telemetry every [ms], {name} requests",
            f"{sorted(gaps)}",
            f"{TELEMETRY_PERIOD} to {most}" if most > TELEMETRY_PERIOD else f"[{TELEMETRY_PERIOD}]",
            good=min(gaps) >= TELEMETRY_PERIOD and max(gaps) <= most,
        )


def at_phases(robot: Robot, seen: Seen, measure: Callable[[Mega], T], within_ms: int = 1) -> list[T]:
    """Return figures measured at full speed, at PHASES evenly spaced moments per ms.

    Random moments would make a quantile differ by a fifth from one choice to the next.
    """
    found = []
    for phase in range(PHASES * within_ms):
        with Mega(robot.firmware) as mega:
            robot.cruise(mega)
            mega.avr.run(phase * CYCLES_PER_MS // PHASES)
            found.append(measure(mega))
            robot.finish(mega, seen)
    return found


def stop(robot: Robot, seen: Seen) -> None:
    """Print the longest delay of STOP.

    The delay lasts until the first step that comes later than in an equal run with PING instead of STOP.
    """

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
    """Return the time (ms) from the last byte of EMERGENCY_STOP to the edge of the enable pin."""
    came = mega.avr.send(encode(FrameType.EMERGENCY_STOP, 1, b""))
    mega.avr.run_ms(5)
    return (float(mega.avr.edges("enable")["cycle"][-1]) - came) / CYCLES_PER_MS


def answer_cycles(mega: Mega, kind: FrameType, payload: bytes) -> tuple[float, float]:
    """Return the times (cycles) from a request's last byte to the first and the last byte of its acknowledgement."""
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
    """Print the times to an acknowledgement at full speed.

    The longest are those of acknowledgements that wait for a TELEMETRY frame that has begun: 29 bytes, 18 560 cycles.
    With the bytes of the acknowledgement itself (8, 5 120 cycles) and the tick (at most 8 000) they take 2 ms.
    """

    def last(mega: Mega) -> float:
        return answer_cycles(mega, kind, payload)[1] / CYCLES_PER_MS

    lasts = at_phases(robot, seen, last, TELEMETRY_PERIOD)
    show(
        f"{robot.name}: {kind.name} to its ACK's last byte, median / p95 / worst [ms]",
        f"{np.median(lasts):.2f} / {np.quantile(lasts, 0.95):.2f} / {max(lasts):.2f}",
        "worst 2",
        good=max(lasts) <= 2,
    )


def flood(robot: Robot, seen: Seen) -> None:
    """Print the lost bytes and the answered PINGs, at full speed while PINGs use two thirds of the serial link."""
    ping = encode(FrameType.PING, 1, b"")
    with Mega(robot.firmware) as mega:
        robot.cruise(mega)
        count = FLOOD_MS * CYCLES_PER_MS // (len(ping) * mega.avr.byte_cycles * 3 // 2)
        mega.tick(0)
        mega.others.clear()
        slept, began = mega.avr.slept, mega.avr.cycle
        for _ in range(count):
            mega.avr.send(ping)
            mega.avr.run(len(ping) * mega.avr.byte_cycles * 3 // 2)
        load = busy(mega, slept, began)
        mega.tick(30)
        figures = f"{mega.avr.overruns} lost, {len(mega.others)} of {count} answered, {100 * load:.1f} % busy"
        show(
            f"{robot.name}: PINGs on two thirds of the link",
            figures,
            "0 lost",
            good=mega.avr.overruns == 0 and len(mega.others) == count,
        )
        robot.finish(mega, seen)


def show_sizes(printed: str) -> None:
    """Print the use of flash and RAM, from the output of avr-size."""
    text, data, bss = (int(word) for word in printed.rsplit("filename", maxsplit=1)[-1].split()[:3])
    show("flash, RAM without stack [bytes]", f"{text + data}, {data + bss}", "253952, 8192")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sketch", action="store_true", help="measure the sketch instead of the hex file")
    target = "arduino" if parser.parse_args().sketch else "mega"
    seen = Seen()
    with tempfile.TemporaryDirectory() as held:
        folder = Path(held)
        firmware, printed = make(target, folder)
        if target == "mega" and firmware.read_bytes() != HEX.read_bytes():
            show("the shipped hex file", "differs from its sources", "equal", good=False)
        robots = [
            Robot("1047 steps/s", firmware, 900, (4189, 4189, 4189)),
            fast_robot(target, folder / "fast"),
        ]
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
    show_sizes(printed)
    show("shortest pulse or pause [us]", f"{seen.pulse / 16:.2f}", "1", good=seen.pulse >= 16)
    show("shortest time from direction to step [ns]", f"{seen.setup * 62.5:.0f}", "200", good=seen.setup >= 4)
    show("steps without power", f"{seen.powerless}", "0", good=not seen.powerless)
    show(f"runs with an inexact position, out of {seen.runs}", f"{seen.inexact}", "0", good=not seen.inexact)
    for name, cycles in seen.longest.items():
        show(
            f"longest {name} interrupt [cycles]",
            f"{cycles}",
            f"{BUDGETS[name]}",
            good=cycles <= BUDGETS[name],
        )


if __name__ == "__main__":
    main()
