"""Reports lost, dropped and late publications to the user and in the recording."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from beatrix_zenoh.recording.losses import Count, Stream, findings, total
from beatrix_zenoh.recording.output import Say
from beatrix_zenoh.recording.rows import RECORDER, Line, Numbers, Row

REPORT_S: Final = 5.0
LOG: Final = f"{RECORDER}/log"


class LossReport:
    """Reports each stream and cause once as soon as it occurs, and the numbers of publications at most every REPORT_S."""

    def __init__(self, say: Say) -> None:
        self._say = say
        self._reported: dict[tuple[Stream, str], str] = {}
        self._reported_s = 0.0

    def rows(
        self, counts: Mapping[Stream, Count], time_ns: int, now_s: float, *, last: bool
    ) -> Iterator[Row]:
        """Show the user what is new; yield its lines, and the numbers of dropped and of lost publications.

        Args:
            counts: the publications so far.
            time_ns: time of the rows by the recorder's wall clock.
            now_s: the recorder's monotonic clock.
            last: the recording ends: write the final numbers; the user reads them in the summary.
        """
        found = findings(counts)
        if found == self._reported or (now_s < self._reported_s + REPORT_S and not last):
            return
        for key, text in found.items():
            if last and text != self._reported.get(key):
                yield Line(LOG, time_ns, time_ns, text, "WARN")
            elif not last and key not in self._reported:
                self._say(f"So far: {text}")
                yield Line(LOG, time_ns, time_ns, f"So far: {text}", "WARN")
        self._reported, self._reported_s = found, now_s
        one = total(counts)
        yield Numbers(f"{RECORDER}/dropped", time_ns, time_ns, (float(one.unwritten),))
        yield Numbers(f"{RECORDER}/lost", time_ns, time_ns, (float(one.lost),))
