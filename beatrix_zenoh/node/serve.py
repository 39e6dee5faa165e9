"""A node as a process: its log output, the wait for the router, a clean end on a signal."""

from __future__ import annotations

import contextlib
import gc
import logging
import os
import queue
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from logging.handlers import QueueHandler
from pathlib import Path

from beatrix_zenoh import bus as zbus
from beatrix_zenoh import files, threads
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract import printable
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage
from beatrix_zenoh.legacy import Terminal
from beatrix_zenoh.node.events import LOGGERS
from beatrix_zenoh.node.node import Node, RobotBody
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.shutdown import FAULT, Shutdown

RETRY_S, REFUSED_S = 0.5, 5.0
"""Pause before the next attempt to connect; longer after a refusal, because each one occupies the router for 0.1 s."""
KEPT = "robots"
"""Folder, inside that of the user, with the teacher's decisions about each robot."""
SWITCH_S = 0.0005
"""Switch interval (s) of Python's threads, short so that a flood of requests does not delay STOP and the publisher."""


def serve(
    build: Callable[[], RobotBody],
    settings: Settings,
    *,
    robot: RobotData = ROBOT,
    ready: bool = False,
    legacy: Path | None = None,
    log_file: Path | None = None,
) -> int:
    """Serve a robot until a signal arrives; return the exit code: FAULT after an uncaught exception in a thread, else 0.

    `ready` (simulation only) switches the motors on and calibrates. `legacy` is the path of the terminal for programs
    of 2023. All log records are written to `log_file`. Prints `ready <key>` when the node serves.

    Raises:
        BeatrixError: the node cannot serve: its name is taken, the router was lost meanwhile, or an option is wrong.
    """
    if legacy is not None and (robot.limits, robot.geometry) != (ROBOT.limits, ROBOT.geometry):
        raise WrongUsage(
            Reason.BAD_VALUE,
            "--legacy cannot be used with a --robot-file that changes limits or neck: for programs of 2023 only "
            "the limits compiled into the firmware apply. Omit one of the two options.",
        )
    shutdown = Shutdown()
    broken: list[threading.ExceptHookArgs] = []

    def give_up(died: threading.ExceptHookArgs) -> None:
        """End the node after an uncaught exception in a thread; otherwise it would answer only some requests."""
        traceback.print_exception(died.exc_type, died.exc_value, died.exc_traceback)
        broken.append(died)
        shutdown.request()

    threading.excepthook = give_up

    shutdown.handle_signals()
    sys.setswitchinterval(SWITCH_S)
    with log_to(log_file):
        sessions = _connect(settings, shutdown)
        if sessions is None:
            return 0
        node = _open(sessions, build(), settings, robot, legacy)
        try:
            if ready:
                node.make_ready()
            gc.freeze()  # without this, garbage collection would stop all threads for milliseconds
            _announce(node, legacy)
            shutdown.wait()
        finally:
            node.close()
    return FAULT if broken else 0


def _announce(node: Node, legacy: Path | None) -> None:
    """Print that the node serves, with or without a board, and the path for programs of 2023."""
    link = node.board.link
    without = "" if link.connected else " (unusable firmware)" if link.contract_differs else " (no board yet)"
    print(f"ready {node.alive_key}{without}", flush=True)
    if legacy is not None:
        print(f"Old programs open {legacy.absolute()}.", file=sys.stderr, flush=True)


def _open(
    sessions: Sessions, hardware: RobotBody, settings: Settings, robot: RobotData, legacy: Path | None
) -> Node:
    """Return a started node; if it cannot start, close `sessions`, `hardware` and the terminal."""
    with ExitStack() as undo:
        undo.callback(hardware.close)
        undo.callback(sessions.close)
        terminal = None if legacy is None else Terminal(legacy)
        if terminal is not None:
            undo.callback(terminal.close)
        node = Node(sessions, settings.robot, hardware, robot, terminal, files.user_folder() / KEPT)
        node.start()
        undo.pop_all()
        return node


def _connect(settings: Settings, shutdown: Shutdown) -> Sessions | None:
    """Connect, waiting for the router if necessary; return None if a signal arrives first."""
    if settings.account is not None:
        settings.account.check_served(settings.robot)
    reported = False
    while True:
        try:
            return Sessions(
                lambda: zbus.connect(settings.connect, label=settings.robot, account=settings.account)
            )
        except NoAnswer as error:
            if not reported:
                print(f"{error.message} The node waits; Ctrl-C ends it.", file=sys.stderr, flush=True)
            reported = True
            if shutdown.requested(REFUSED_S if error.reason is Reason.ACCOUNT_REFUSED else RETRY_S):
                return None


CAPACITY = 10_000
"""Largest number of waiting records; further ones are dropped, because stderr may be a pipe that no program reads."""
CLOSE_S = 1.0
STDERR = 2


class Writer:
    """Writes records on a thread of its own, so that a blocked stderr does not delay the robot."""

    def __init__(self, file: logging.Handler | None) -> None:
        self._records: queue.Queue[logging.LogRecord | None] = queue.Queue(CAPACITY)
        self._file = file
        self.handler = Enqueue(self._records)
        self._thread = threads.start(self._run, "log")

    def _run(self) -> None:
        while (record := self._records.get()) is not None:
            if self._file is not None:
                self._file.handle(record)
            if record.levelno >= logging.WARNING:
                print_raw(printable.line(record.getMessage()))

    def close(self) -> None:
        """Write the waiting records, for CLOSE_S at most; if the queue is full, return at once."""
        try:
            self._records.put_nowait(None)
        except queue.Full:
            return
        self._thread.join(CLOSE_S)
        if self._file is not None and not self._thread.is_alive():
            with contextlib.suppress(OSError):  # for example a full disk, which LogFile has reported
                self._file.close()


class Enqueue(QueueHandler):
    """A handler that drops records when the queue is full."""

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 - the name is logging's
        """Ignore that the queue is full."""


class OneLine(logging.Formatter):
    """Formats a record as one line, because its message may quote a request; a traceback follows on further lines."""

    def formatMessage(self, record: logging.LogRecord) -> str:  # noqa: N802 - the name is logging's
        """Return the line of a record."""
        return printable.line(super().formatMessage(record))


class LogFile(logging.FileHandler):
    """A log file that reports its first error in one line and then writes nothing more."""

    broken = False

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record, unless an earlier one could not be written."""
        if not self.broken:
            super().emit(record)

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: ARG002, N802 - the name is logging's
        """Report the cause and stop writing; logging would print a traceback for every record."""
        self.broken = True
        print_raw(f"--log-file {self.baseFilename}: {sys.exc_info()[1]}. Nothing more is written there.")


def print_raw(text: str) -> None:
    """Print a line on stderr without taking a lock of Python, so that the process can end while the write blocks."""
    with contextlib.suppress(OSError):  # the terminal was closed
        os.write(STDERR, f"{text}\n".encode(errors="replace"))


@contextmanager
def log_to(path: Path | None) -> Iterator[None]:
    """Until the context ends, write warnings of our loggers to stderr and all their records to `path`; None: no file.

    Raises:
        WrongUsage: BAD_VALUE, the file cannot be written.
    """
    writer = Writer(None if path is None else _file(path))
    loggers = [logging.getLogger(name) for name in LOGGERS]
    before = [(logger, logger.level, logger.propagate) for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.INFO)
        logger.propagate = False
        logger.addHandler(writer.handler)
    try:
        yield
    finally:
        for logger, level, propagate in before:
            logger.removeHandler(writer.handler)
            logger.setLevel(level)
            logger.propagate = propagate
        writer.close()


def _file(path: Path) -> logging.Handler:
    try:
        handler = LogFile(path, encoding="utf-8")
    except OSError as error:
        raise WrongUsage(
            Reason.BAD_VALUE, f"--log-file {path}: {error.strerror}. Name a file that can be written."
        ) from error
    handler.setFormatter(OneLine("%(asctime)s %(levelname)s %(name)s: %(message)s"))
    return handler
