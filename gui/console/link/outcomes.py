"""Outcomes of requests, made from return values and errors of the SDK."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from beatrix_zenoh.client import Place
from beatrix_zenoh.contract._generated.messages import Detail, Reason
from beatrix_zenoh.contract.errors import BeatrixError, Interrupted, NoAnswer
from gui.console.state.actions import Outcome, WriteFile

NO_ROBOT = "No robot is online."


class WindowError(Interrupted):
    """A failure of the window itself: a text of the faces, by its key, says why."""

    def __init__(self, reason: Reason, key: str, detail: Detail | None = None, **slots: str | float) -> None:
        """Take the arguments of every `BeatrixError`: the SDK makes a copy with further lines in its message."""
        super().__init__(reason, key, detail)
        self.key, self.slots = key.partition("\n")[0], slots


def done(row: int, side: str, message: str, took_s: float = 0.0) -> Outcome:
    """Return the outcome of a request that succeeded; `took_s` in s."""
    return Outcome(row, side, accepted=True, done=True, message=message, duration_s=took_s)


def accepted(row: int, side: str, message: str, lasts_s: float) -> Outcome:
    """Return the outcome of an accepted motion that will last `lasts_s` (s)."""
    return Outcome(row, side, accepted=True, done=False, message=message, duration_s=lasts_s)


def failed(row: int, side: str, error: BeatrixError) -> Outcome:
    """Return the outcome of a refused request, or of a motion that did not reach its goal."""
    return Outcome(
        row,
        side,
        accepted=False,
        done=True,
        reason=error.reason,
        message=error.message,
        detail=error.detail,
        key=error.key if isinstance(error, WindowError) else "",
        slots=error.slots if isinstance(error, WindowError) else {},
    )


def of_several(row: int, robots: int, errors: Mapping[Place, BeatrixError]) -> Outcome:
    """Return the outcome of a request to `robots` robots; `errors` contains those of robots that failed."""
    error = next(iter(errors.values()), None if robots else NoAnswer(Reason.NO_ANSWER, NO_ROBOT))
    outcome = done(row, "", "") if error is None else failed(row, "", error)
    return replace(outcome, robots=robots, failed=tuple("{} ({})".format(*place) for place in errors))


def write(action: WriteFile) -> Outcome:
    """Write the file of an action, and return the outcome."""
    file, content = action.file, action.content
    try:
        file.write_bytes(content.encode() if isinstance(content, str) else content)
    except OSError:
        return failed(action.row, "", WindowError(Reason.BAD_VALUE, "result.no_write", file=str(file)))
    return done(action.row, "", f"{file}: written.")


def replaced() -> WindowError:
    """Return the error of a motion that a newer one of this window replaces."""
    return WindowError(Reason.REPLACED, "result.replaced")


def stopped() -> WindowError:
    """Return the error of a request that STOP of this window has dropped or ended."""
    return WindowError(Reason.STOPPED, "result.stop_pressed")
