"""The serial ports of this computer, as a child process lists them: only the hardware node knows serial ports."""

from __future__ import annotations

import time
from typing import Final

from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.processes import POLL_S, Supervisor
from gui.console.link.jobs import Jobs
from gui.console.state.world import UsbPort

LIST_S: Final = 15.0
"""Time limit of the child; a busy computer may need several seconds to start Python."""
END_S: Final = 1.0


class Ports:
    """Lists the ports."""

    def __init__(self, jobs: Jobs) -> None:
        self._jobs = jobs
        self._closed = False
        self.newest: tuple[UsbPort, ...] | None = None
        """the ports found last; None: not known yet"""

    def look(self) -> None:
        """List the ports anew; returns at once."""
        self.newest = None
        self._jobs.put("ports", self._look)

    def _look(self) -> None:
        processes = Supervisor()
        try:
            child = processes.start("ports", "hw", "--ports")
            deadline_s = time.monotonic() + LIST_S
            while child.code is None and not self._closed and time.monotonic() < deadline_s:
                time.sleep(POLL_S)
            self.newest = parsed(child.lines()) if child.code == 0 else ()
        except (BeatrixError, OSError):
            self.newest = ()
        finally:
            processes.end_all(time.monotonic() + END_S)

    def close(self) -> None:
        """End the child soon."""
        self._closed = True


def parsed(lines: list[str]) -> tuple[UsbPort, ...]:
    """Return the ports of the output of `beatrix hw --ports`, boards first."""
    rows = [line.split("\t") for line in lines if line.count("\t") == 2]
    ports = [UsbPort(device, title, board=kind == "board") for kind, device, title in rows]
    return tuple(sorted(ports, key=lambda port: not port.board))
