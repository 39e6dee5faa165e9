"""Reports lost, dropped and late publications to the user and in the recording."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

from beatrix_zenoh.recording.losses import Count, Stream, sentences, total
from beatrix_zenoh.recording.output import Say
from beatrix_zenoh.recording.rows import RECORDER, Line, Numbers, Row

REPORT_S: Final = 5.0


class LossReport:
    """Reports each change of the counts, at most every REPORT_S."""

    def __init__(self, say: Say) -> None:
        self._say = say
        self._reported: tuple[str, ...] = ()
        self._reported_s = 0.0

    def rows(
        self, counts: Mapping[Stream, Count], time_ns: int, now_s: float, *, last: bool
    ) -> Iterator[Row]:
        """Show the user what has changed; yield its lines, and the numbers of dropped and of lost publications.

        Args:
            counts: the publications so far.
            time_ns: time of the rows by the recorder's wall clock.
            now_s: the recorder's monotonic clock.
            last: the recording ends: report now, but only in the recording, because the summary names all counts.
        """
        texts = tuple(sentences(counts))
        if texts == self._reported or (now_s < self._reported_s + REPORT_S and not last):
            return
        for text in texts:
            if text not in self._reported:
                if not last:
                    self._say(f"So far: {text}")
                yield Line(f"{RECORDER}/log", time_ns, time_ns, text, "WARN")
        self._reported, self._reported_s = texts, now_s
        one = total(counts)
        yield Numbers(f"{RECORDER}/dropped", time_ns, time_ns, (float(one.unwritten),))
        yield Numbers(f"{RECORDER}/lost", time_ns, time_ns, (float(one.lost),))
