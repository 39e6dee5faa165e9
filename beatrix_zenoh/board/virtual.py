"""The virtual board: the firmware as WebAssembly in virtual time, behind a port like a serial one."""

from __future__ import annotations

import itertools
import struct
import threading
import time
from collections.abc import Callable
from typing import Final, Protocol

from beatrix_zenoh.board import wasm
from beatrix_zenoh.contract._generated.serial import TELEMETRY_PERIOD

_NAME_SIZE: Final = 32
_REPORT: Final = struct.Struct("<6q6iIII")
"""Report of firmware/virtual/board.cpp: start, end, steps, pulses, drivers on, bytes to transmit, input pending."""
_LENGTH: Final = struct.Struct("<I")
_LENGTH_AT: Final = _REPORT.size - 2 * _LENGTH.size
_TICK: Final = struct.Struct("<3iI")
"""Tick of firmware/virtual/board.cpp: pulses, drivers on."""
TICKS: Final = 100
"""Largest number of ticks (ms) of a call of `Firmware.tick` whose pulses are kept, as in firmware/virtual/board.cpp."""
_TRANSMIT_SIZE: Final = 16384
"""Size of the transmit buffer (bytes), as in firmware/virtual/board.cpp."""
_TICKS_PER_CALL: Final = 1000
"""Largest number of milliseconds per call of `tick`; the telemetry of 3000 ms fits into the transmit buffer."""
_CATCH_UP_MS: Final = 100
"""Longest time to advance in one step when the board is late: well under the firmware's heartbeat timeout."""
_STALL_MS: Final = 300
"""Longest stall of the process to catch up with; a longer one is skipped, so that the firmware misses no heartbeat."""
_UNREAD_MS: Final = 100
"""The host is late if bytes have been unread for longer. The sum of this time, one step and a heartbeat period is less
than the heartbeat timeout."""
_STEP_MS: Final = 5
_PERIOD_MS: Final = 2 * TELEMETRY_PERIOD
"""Period of the turns of a board: that of the publications of positions."""
BUSY_S: Final = 0.03
"""Time (s) after a write for which a board has a turn for each telemetry, so that a command shows in the next one."""
_UNREAD_MAX: Final = 65536
"""Largest number of bytes kept for a reader; older ones are lost, as on a serial port without a reader."""


class Firmware:
    """One board in virtual time, which passes only in `tick`. Not thread-safe.

    `boot` is the boot number that the board reports, `name` the robot name in its memory (empty: none).
    Raises BeatrixError if wasmtime is missing.
    """

    def __init__(self, boot: int = 1, name: str = "") -> None:
        engine, module = wasm.compiled()
        import wasmtime  # noqa: PLC0415 - an optional dependency, as in `wasm`

        self._store = wasmtime.Store(engine)
        exports = wasmtime.Instance(self._store, module, []).exports(self._store)
        self._memory = exports["memory"]
        self._functions = {
            name: wasm.direct(self._store, exports[name]) for name in exports if name != "memory"
        }
        self._receive_at: int = self._call("receive_buffer")
        self._receive_size: int = self._call("receive_size")
        self._transmit_at: int = self._call("transmit_buffer")
        report_at: int = self._call("report_buffer")
        # Create the views once. The memory never moves: there is no heap.
        self._report_view = self._view(report_at, _REPORT.size)
        self._receive_view = self._view(self._receive_at, self._receive_size)
        self._transmit_view = self._view(self._transmit_at, _TRANSMIT_SIZE)
        self._ticks_view = self._view(self._call("tick_buffer"), TICKS * _TICK.size)
        self._memory.write(
            self._store, name.encode("ascii").ljust(_NAME_SIZE, b"\0"), self._call("name_buffer")
        )
        self._call("start", boot)
        self._sent = bytearray()

    def receive(self, data: bytes) -> None:
        """Pass bytes to the serial port; the firmware processes and answers them before this method returns."""
        rest = bytes(data)
        while rest or self._report()[14]:
            chunk = rest[: self._receive_size]
            self._receive_view[: len(chunk)] = chunk
            rest = rest[self._call("receive", len(chunk)) :]
            self._drain()

    def transmit(self) -> bytes:
        """Return the bytes that the board has sent since the last call."""
        self._drain()
        sent = bytes(self._sent)
        self._sent.clear()
        return sent

    def tick(self, ms: int) -> None:
        """Let `ms` milliseconds pass."""
        while ms > 0:
            self._call("tick", min(ms, _TICKS_PER_CALL))
            ms -= _TICKS_PER_CALL
            if ms > 0:
                self._drain()

    def steps(self) -> tuple[int, int, int]:
        """Return the set points in whole microsteps from home, as in TELEMETRY."""
        x, y, z = self._report()[6:9]
        return x, y, z

    def pulses(self) -> tuple[int, int, int]:
        """Return the microsteps sent to the motors since start, forward minus backward.

        Calibration does not reset them.
        """
        x, y, z = self._report()[9:12]
        return x, y, z

    def motors(self, ms: int, period_ms: int) -> list[tuple[tuple[int, int, int], bool, int]]:
        """Return `pulses` and `drivers_on` at the end of each `period_ms` of the last call of `tick`, which took `ms`.

        Each entry is followed by the number of periods in a row for which it holds. `ms`: at most TICKS, a multiple of
        `period_ms`.
        """
        runs: list[tuple[tuple[int, int, int], bool, int]] = []
        ticks = list(_TICK.iter_unpack(self._ticks_view[: ms * _TICK.size]))[period_ms - 1 :: period_ms]
        for (x, y, z, on), same in itertools.groupby(ticks):
            runs.append(((x, y, z), bool(on), len(list(same))))
        return runs

    def set_points(self) -> tuple[float, float, float]:
        """Return the set points in microsteps from home, with fractions."""
        x, y, z = (end / (1 << 26) for end in self._report()[3:6])
        return x, y, z

    def drivers_on(self) -> bool:
        """Return whether the motors are powered."""
        return bool(self._report()[12])

    def snapshot(self) -> bytes:
        """Return the whole state of the board, for `restore` of this or another Firmware."""
        self._drain()
        return bytes(self._memory.read(self._store))

    def restore(self, snapshot: bytes) -> None:
        """Set the state of the board to a snapshot; discard bytes that `transmit` has not returned yet."""
        self._memory.write(self._store, snapshot)
        self._sent.clear()

    def _call(self, name: str, *arguments: int) -> int:
        return self._functions[name](*arguments)

    def _view(self, at: int, size: int) -> memoryview:
        return memoryview(self._memory.get_buffer_ptr(self._store, size, at)).cast("B")

    def _report(self) -> tuple[int, ...]:
        return _REPORT.unpack_from(self._report_view)

    def _drain(self) -> None:
        length = self._report()[13]
        if length:
            self._sent += self._transmit_view[:length]
            _LENGTH.pack_into(self._report_view, _LENGTH_AT, 0)  # same effect as the firmware's drain()


class VirtualBoard:
    """A port to the firmware in virtual time; time passes only while `advance` runs. Thread-safe.

    Hold `lock` when using `firmware` directly.
    """

    name: Final = "virtual:"
    boot_s: Final = 0.0

    def __init__(self, firmware: Firmware) -> None:
        self.firmware = firmware
        self.lock = threading.RLock()
        self._arrived = threading.Condition(self.lock)
        self._unread = bytearray()
        self._unread_ms = 0
        self._closed = False
        self.written = False
        """Set by `wake`: bytes were written since the last turn."""
        self.notify: Callable[[], None] = lambda: None
        """Called by `wake`, for the thread that gives the board its turns."""
        with self.lock:
            self._collect()

    def write(self, data: bytes) -> bytes:
        """Process bytes at once; return the answer of the board, which `read` returns as well.

        A waiting reader is woken by `wake` or by the next `advance`. Raises OSError after `close`.
        """
        with self.lock:
            if self._closed:
                raise OSError("the virtual board is closed")
            self.firmware.receive(data)
            answer = self.firmware.transmit()
            self._keep(answer)
        return answer

    def wake(self) -> None:
        """Wake the reader, and the thread that gives the board its turns."""
        with self.lock:
            self._arrived.notify_all()
        self.written = True
        self.notify()

    def read(self, timeout_s: float) -> bytes:
        """Return the unread bytes, waiting up to `timeout_s` for the first; empty if none arrive, or after `close`."""
        with self.lock:
            self._arrived.wait_for(lambda: self._unread or self._closed, timeout_s)
            if self._closed:
                return b""
            data = bytes(self._unread)
            self._unread.clear()
            self._unread_ms = 0
            return data

    def advance(self, ms: int) -> None:
        """Advance the board's time by `ms` milliseconds."""
        with self.lock:
            if self._unread:
                self._unread_ms += ms
            self.firmware.tick(ms)
            self._collect()

    @property
    def host_is_late(self) -> bool:
        """Whether the reader's thread, which also sends the heartbeat, has not run for a while, as on a busy computer.

        Do not advance the board meanwhile: otherwise the firmware would miss the heartbeat of a host that still runs.
        """
        return self._unread_ms > _UNREAD_MS

    def close(self) -> None:
        """Wake the reader and reject writes; the state of the firmware does not change."""
        with self.lock:
            self._closed = True
            self._arrived.notify_all()

    def _collect(self) -> None:
        self._keep(self.firmware.transmit())
        if self._unread:
            self._arrived.notify_all()

    def _keep(self, sent: bytes) -> None:
        self._unread += sent
        del self._unread[:-_UNREAD_MAX]


class BoardTime(Protocol):
    """The time of a virtual board, which passes in turns."""

    def wait_s(self) -> float:
        """Return the time (s) until the next turn is due; negative if it is late."""

    def turn(self, *, written: bool) -> None:
        """Advance the board to the present time; `written`: bytes were written to it since the last turn."""


class TimedPort(VirtualBoard):
    """The port of a virtual board whose time passes in the thread that reads; `read` does not wait.

    One thread thus advances the board, decodes its frames and sends the heartbeat, without a hand-over between threads.
    While the thread does not read, the board waits for it.
    """

    def __init__(self, firmware: Firmware, time_of: Callable[[VirtualBoard], BoardTime]) -> None:
        """`time_of` returns the time of this board."""
        super().__init__(firmware)
        self._time = time_of(self)

    def due_s(self) -> float:
        """Return the monotonic time (s) at which `read` should be called again."""
        return time.monotonic() + self._time.wait_s()

    def read(self, timeout_s: float) -> bytes:  # noqa: ARG002 - it never waits
        """Give the board a turn if one is due, and return what it has sent; empty after `close`."""
        written = self.written
        if written:
            self.written = False
        if written or self._time.wait_s() <= 0:  # another thread may have advanced the board meanwhile
            self._time.turn(written=written)
        return super().read(0)


class RealTime:
    """The time of a board without physics; makes up for late turns and waits for a late host."""

    def __init__(self, board: VirtualBoard) -> None:
        self._board = board
        self._start_s = self._busy_until_s = time.monotonic()
        self._done_ms = 0

    def wait_s(self) -> float:
        """Return the time (s) until the next turn, at a tick of the telemetry, so that this arrives without delay."""
        now_s = time.monotonic()
        period_ms = TELEMETRY_PERIOD if now_s < self._busy_until_s else _PERIOD_MS
        next_ms = self._done_ms - self._done_ms % period_ms + period_ms
        return self._start_s + next_ms / 1000 - now_s

    def turn(self, *, written: bool) -> None:
        """Advance the board to the present time, in steps between which the host can send its heartbeat."""
        now_s = time.monotonic()
        if written:
            self._busy_until_s = now_s + BUSY_S
        due_ms = int((now_s - self._start_s) * 1000)
        due_ms -= due_ms % _STEP_MS
        if due_ms - self._done_ms > _STALL_MS or self._board.host_is_late:
            self._start_s += (due_ms - self._done_ms) / 1000
            return
        due_ms = min(due_ms, self._done_ms + _CATCH_UP_MS)
        self._board.advance(due_ms - self._done_ms)
        self._done_ms = due_ms
