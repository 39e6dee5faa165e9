"""The log output of a process that serves robots: warnings on stderr, all records in a file."""

from __future__ import annotations

import contextlib
import logging
import os
import queue
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from logging.handlers import QueueHandler
from pathlib import Path

from beatrix_zenoh import threads
from beatrix_zenoh.contract import printable
from beatrix_zenoh.contract.errors import wrong_usage

LOGGERS = ("beatrix_zenoh", "sim_node", "hw_node")
CAPACITY = 10_000
"""Largest number of waiting records; further ones are dropped, because stderr may be a pipe that no program reads."""
CLOSE_S = 1.0
STDERR = 2


class Writer:
    """Writes records on a thread of its own, so that a blocked stderr does not delay the robot."""

    def __init__(self, file: logging.Handler | None, *, named: bool) -> None:
        self._records: queue.Queue[logging.LogRecord | None] = queue.Queue(CAPACITY)
        self._file = file
        self.handler = Enqueue(self._records, named=named)
        self._thread = threads.start(self._run, "log")

    def _run(self) -> None:
        while (record := self._records.get()) is not None:
            line = printable.line(record.getMessage())
            if self._file is not None:
                self._file.handle(record)
            if record.levelno >= logging.WARNING:
                print_raw(line)

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

    def __init__(self, records: queue.Queue[logging.LogRecord | None], *, named: bool) -> None:
        """Put records into a queue; `named`: with the name of their robot."""
        super().__init__(records)
        self._named = named

    def enqueue(self, record: logging.LogRecord) -> None:
        """Put the copy of a record, on the thread that logs, into the queue; raises queue.Full."""
        owner = threads.OWNER.get()
        if self._named and owner is not None:
            record.msg = f"{owner.name}: {record.msg}"
        self.queue.put_nowait(record)

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
def log_to(path: Path | None, *, named: bool = False) -> Iterator[None]:
    """Until the context ends, write warnings of our loggers to stderr and all their records to `path`; None: no file.

    `named`: begin each message with the name of its robot, because the process serves several.

    Raises:
        WrongUsage: BAD_VALUE, the file cannot be written.
    """
    writer = Writer(None if path is None else _file(path), named=named)
    loggers = [logging.getLogger(name) for name in LOGGERS]
    before = [(logger, logger.level, logger.propagate) for logger in loggers]
    # Without a file records of lower levels are not even made: each would also wake the thread of the writer.
    level_used = logging.WARNING if path is None else logging.INFO
    for logger in loggers:
        logger.setLevel(level_used)
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
    if path.is_fifo():  # opening it waits for a reader
        raise wrong_usage(f"--log-file {path} is a pipe. Name a file that can be written.")
    try:
        handler = LogFile(path, encoding="utf-8")
    except OSError as error:
        raise wrong_usage(f"--log-file {path}: {error.strerror}. Name a file that can be written.") from error
    handler.setFormatter(OneLine("%(asctime)s %(levelname)s %(name)s: %(message)s"))
    return handler
