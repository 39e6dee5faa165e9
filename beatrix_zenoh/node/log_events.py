"""Log records of Python as events of the robot."""

from __future__ import annotations

import logging

from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated.messages import EventKind
from beatrix_zenoh.node import events
from beatrix_zenoh.node.component import Component

LOGGERS = ("beatrix_zenoh", "sim_node", "hw_node")


class LogEvents(Component, logging.Handler):
    """Adds each record of our loggers to the event log, except the records of the event log itself."""

    def __init__(self, log: events.EventLog) -> None:
        logging.Handler.__init__(self, logging.INFO)
        self._events = log

    def start(self, sessions: Sessions) -> None:  # noqa: ARG002
        for name in LOGGERS:
            logging.getLogger(name).addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Add a record; called by logging, on any thread."""
        if record.name != events.log.name:
            message = f"{record.name}: {record.getMessage()}"
            self._events.add(EventKind.LOG, action=record.levelname, message=message)

    def close(self) -> None:
        """Remove the handler."""
        for name in LOGGERS:
            logging.getLogger(name).removeHandler(self)
        logging.Handler.close(self)
