"""The firmware itself without a board: WebAssembly, virtual time, and a port that behaves like a serial one."""

from __future__ import annotations

import atexit
import struct
import threading
import time
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Final

from beatrix_zenoh import threads
from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.errors import BeatrixError

if TYPE_CHECKING:
    from wasmtime import Engine, Module

_NAME_SIZE: Final = 32
_REPORT: Final = struct.Struct("<6q6iII")
"""Report of firmware/virtual/board.cpp: start, end, steps, pulses, drivers on, bytes to transmit."""
_TICKS_AT_ONCE: Final = 1000
"""Milliseconds a call; the firmware's transmit buffer holds the telemetry of three times that."""
_CATCH_UP_MS: Final = 100
"""Milliseconds made up for at once: well under the firmware's heartbeat timeout."""
_STALL_MS: Final = 300
"""Held up for longer, the board's time has stood still like that of its host: no heartbeat is missed."""
_UNREAD_MS: Final = 100
"""With a slice and the heartbeat's period on top still under the heartbeat timeout."""
_BREATH_S: Final = 0.001
_UNREAD_MAX: Final = 65536
"""Bytes kept for a reader; what is older is lost, as on a serial port nobody reads."""


@cache
def _compiled() -> tuple[Engine, Module]:
    """Compile the firmware; once a process, since modules are immutable and shared between instances."""
    try:
        import wasmtime  # noqa: PLC0415 - the library works without; only a virtual board needs it
    except ImportError as error:
        raise BeatrixError(
            Reason.BOARD_LOST,
            "A virtual board needs wasmtime, which is not installed: "
            'pip install ".[sim]" in the folder of BEATRIX, then try again.',
        ) from error
    engine = wasmtime.Engine()
    code = (resources.files("beatrix_zenoh.board") / "firmware.wasm").read_bytes()
    return engine, wasmtime.Module(engine, code)


atexit.register(_compiled.cache_clear)  # wasmtime cannot free what outlives its own module


class Firmware:
    """One board in virtual time: nothing happens between calls. Not thread-safe.

    `boot` is the boot number it reports, `name` the robot name in its memory (empty: none yet).
    Raises BeatrixError if wasmtime is missing.
    """

    def __init__(self, boot: int = 1, name: str = "") -> None:
        engine, module = _compiled()
        import wasmtime  # noqa: PLC0415 - as above

        self._store = wasmtime.Store(engine)
        exports = wasmtime.Instance(self._store, module, []).exports(self._store)
        self._memory = exports["memory"]
        self._functions = {name: exports[name] for name in exports if name != "memory"}
        self._receive_at: int = self._call("receive_buffer")
        self._receive_size: int = self._call("receive_size")
        self._transmit_at: int = self._call("transmit_buffer")
        report_at: int = self._call("report_buffer")
        # A view made once, for a simulation reads it 500 times a second. The memory never moves: the firmware has no heap.
        self._report_view = self._memory.get_buffer_ptr(self._store, _REPORT.size, report_at)
        self._memory.write(
            self._store, name.encode("ascii").ljust(_NAME_SIZE, b"\0"), self._call("name_buffer")
        )
        self._call("start", boot)
        self._sent = bytearray()

    def receive(self, data: bytes) -> None:
        """Give bytes to the serial port; frames are processed, and answered, before this returns."""
        rest = bytes(data)
        while rest:
            chunk = rest[: self._receive_size]
            self._memory.write(self._store, chunk, self._receive_at)
            rest = rest[self._call("receive", len(chunk)) :]
            self._drain()

    def transmit(self) -> bytes:
        """Everything the board has sent since the last call."""
        self._drain()
        sent = bytes(self._sent)
        self._sent.clear()
        return sent

    def tick(self, ms: int) -> None:
        """Let `ms` milliseconds pass."""
        while ms > 0:
            self._call("tick", min(ms, _TICKS_AT_ONCE))
            ms -= _TICKS_AT_ONCE
            if ms > 0:
                self._drain()

    def steps(self) -> tuple[int, int, int]:
        """Set points in whole microsteps from home, as TELEMETRY reports them."""
        x, y, z = self._report()[6:9]
        return x, y, z

    def pulses(self) -> tuple[int, int, int]:
        """Microsteps given to the motors since start, forward minus backward; calibration leaves them alone."""
        x, y, z = self._report()[9:12]
        return x, y, z

    def set_points(self) -> tuple[float, float, float]:
        """Exact set points in microsteps from home, between two steps as well."""
        x, y, z = (end / (1 << 26) for end in self._report()[3:6])
        return x, y, z

    def outputs(self) -> tuple[tuple[int, int, int], bool]:
        """`pulses` and `drivers_on` in one."""
        report = self._report()
        x, y, z = report[9:12]
        return (x, y, z), bool(report[12])

    def drivers_on(self) -> bool:
        """Say whether the motors hold."""
        return bool(self._report()[12])

    def snapshot(self) -> bytes:
        """All there is to know of the board, for `restore` of this or another Firmware."""
        self._drain()
        return bytes(self._memory.read(self._store))

    def restore(self, snapshot: bytes) -> None:
        """Become the board of the snapshot; what it sent before is not sent again."""
        self._memory.write(self._store, snapshot)
        self._sent.clear()

    def _call(self, name: str, *arguments: int) -> int:
        result: int = self._functions[name](self._store, *arguments)
        return result

    def _report(self) -> tuple[int, ...]:
        return _REPORT.unpack_from(self._report_view)

    def _drain(self) -> None:
        length = self._report()[13]
        if length:
            self._sent += self._memory.read(self._store, self._transmit_at, self._transmit_at + length)
            self._call("drain")


class VirtualBoard:
    """A port with the firmware behind it, in virtual time: somebody has to call `advance`. Thread-safe.

    Take `lock` around any use of `firmware` beside it.
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
        self.spoken_to = threading.Event()
        """Set by every write: whoever advances an idle board need not let it wait."""
        with self.lock:
            self._collect()

    def write(self, data: bytes) -> None:
        """Process bytes at once. Raises OSError after `close`."""
        with self.lock:
            if self._closed:
                raise OSError("the virtual board is closed")
            self.firmware.receive(data)
            self._collect()
        self.spoken_to.set()

    def read(self, timeout_s: float) -> bytes:
        """All bytes that are there, waiting up to `timeout_s` for the first; empty if none came or after `close`."""
        with self.lock:
            self._arrived.wait_for(lambda: self._unread or self._closed, timeout_s)
            if self._closed:
                return b""
            data = bytes(self._unread)
            self._unread.clear()
            self._unread_ms = 0
            return data

    def advance(self, ms: int) -> None:
        """Let `ms` milliseconds of the board's time pass."""
        with self.lock:
            if self._unread:
                self._unread_ms += ms
            self.firmware.tick(ms)
            self._collect()

    @property
    def host_is_late(self) -> bool:
        """What the board says has not been read for a while: a busy computer has forgotten the reader's thread.

        The heartbeat comes from that thread. Who keeps the board's time lets it stand still meanwhile: here board and
        host are one process, and neither is to miss the other.
        """
        return self._unread_ms > _UNREAD_MS

    def close(self) -> None:
        """Wake the reader and refuse writers; the firmware stays as it is."""
        with self.lock:
            self._closed = True
            self._arrived.notify_all()

    def _collect(self) -> None:
        sent = self.firmware.transmit()
        if sent:
            self._unread += sent
            del self._unread[:-_UNREAD_MAX]
            self._arrived.notify_all()


class RealTimeTicker:
    """Advances a board with the wall clock, every `period_ms`, until `close`; late ticks are made up for, a late host is waited for."""

    def __init__(self, board: VirtualBoard, period_ms: int = 5) -> None:
        self._board = board
        self._period_ms = period_ms
        self._closing = threading.Event()
        self._thread = threads.start(self._run, "virtual-time")

    def _run(self) -> None:
        start_s = time.monotonic()
        done_ms = 0
        while not self._closing.wait(start_s + (done_ms + self._period_ms) / 1000 - time.monotonic()):
            due_ms = int((time.monotonic() - start_s) * 1000)
            due_ms -= due_ms % self._period_ms
            if due_ms - done_ms > _STALL_MS or self._board.host_is_late:
                start_s += (due_ms - done_ms) / 1000
                continue
            # After a stall in slices, between which the host's heartbeat gets through.
            due_ms = min(due_ms, done_ms + _CATCH_UP_MS)
            self._board.advance(due_ms - done_ms)
            done_ms = due_ms
            self._closing.wait(_BREATH_S)

    def close(self) -> None:
        """Stop time and wait for the thread's end."""
        self._closing.set()
        self._thread.join()
