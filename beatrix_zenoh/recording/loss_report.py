"""Reports lost, dropped and late publications to the user and in the recording."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from beatrix_zenoh.recording.losses import CONTESTED, Count, Stream, findings, total
from beatrix_zenoh.recording.output import Say
from beatrix_zenoh.recording.rows import RECORDER, Line, Numbers, Row

REPORT_S: Final = 5.0
LASTS_S: Final = 1.0
"""Time (s) for which a cause must be there before the user reads it: the numbers of two programs look like losses first."""
LOG: Final = f"{RECORDER}/log"


class LossReport:
    """Reports each stream and cause once, LASTS_S after it occurs, and the numbers of publications at most every REPORT_S."""

    def __init__(self, say: Say) -> None:
        self._say = say
        self._reported: dict[tuple[Stream, str], str] = {}
        self._reported_s = 0.0
        self._since_s: dict[tuple[Stream, str], float] = {}

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
        self._since_s = {key: self._since_s.get(key, now_s) for key in found}
        if not last:
            found = {key: text for key, text in found.items() if now_s - self._since_s[key] >= LASTS_S}
        if found == self._reported or (now_s < self._reported_s + REPORT_S and not last):
            return
        for key, text in found.items():
            if last and text != self._reported.get(key):
                yield Line(LOG, time_ns, time_ns, text, "WARN")
            elif not last and key not in self._reported:
                so_far = text if key[1] == CONTESTED else f"So far: {text}"
                self._say(so_far)
                yield Line(LOG, time_ns, time_ns, so_far, "WARN")
        self._reported, self._reported_s = found, now_s
        one = total(counts)
        yield Numbers(f"{RECORDER}/dropped", time_ns, time_ns, (float(one.unwritten),))
        if not one.contested:
            yield Numbers(f"{RECORDER}/lost", time_ns, time_ns, (float(one.lost),))
