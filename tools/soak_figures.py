"""What `tools/soak.py` measures: memory, descriptors, threads and processor time of processes, and the page with them."""

from __future__ import annotations

import contextlib
import os
import platform
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path
from statistics import median, median_high
from typing import Final

from bench_node import ROOT, cpu_s

sys.path.append(str(ROOT / "tests/support"))
from robots import children

BEGIN_S: Final = 600.0
"""Time (s) after which nothing may grow; before, histories and caches become full."""
WINDOW_S: Final = 300.0
"""Length of the windows that are compared: after BEGIN_S, half way from there to the end, and at the end."""
GROWTH: Final = 0.03
"""Largest share by which the memory of a process may grow; below NOISE_MIB nothing counts as growth."""
NOISE_MIB: Final = 2.0
MORE: Final = 2
"""Descriptors and threads that a process may have in addition: some come and go."""


@dataclass(frozen=True)
class Look:
    """A process at one time."""

    at_s: float
    """time since the start of the soak"""
    rss_mib: float
    """resident memory"""
    own_mib: float
    """the part of it that belongs to no file: what leaks"""
    descriptors: int
    threads: int
    cpu_s: float
    pid: int


def look(pid: int, at_s: float) -> Look | None:
    """Look at a process; return None if it has ended."""
    with contextlib.suppress(OSError):
        kib: dict[str, int] = {}
        for line in Path(f"/proc/{pid}/status").read_text(encoding="utf-8").splitlines():
            name, _, value = line.partition(":")
            if name in {"VmRSS", "RssAnon", "Threads"}:
                kib[name] = int(value.split()[0])
        if "VmRSS" not in kib:  # it has ended, and its parent has not yet read its exit code
            return None
        descriptors = len(list(Path(f"/proc/{pid}/fd").iterdir()))
        return Look(
            at_s, kib["VmRSS"] / 1024, kib["RssAnon"] / 1024, descriptors, kib["Threads"], cpu_s(pid), pid
        )
    return None


def title(command: str) -> str:
    """Return a short name of a child process: the last part of its module."""
    words = command.split()
    module = words[words.index("-m") + 1] if "-m" in words else Path(words[0]).name if words else "child"
    return module.rpartition(".")[2]


@dataclass
class Book:
    """Looks at all processes, by the names of the processes: those in the windows, so that this process does not grow."""

    total_s: float
    """length of the soak"""
    looks: dict[str, list[Look]] = field(default_factory=dict)
    last_s: dict[str, float] = field(default_factory=dict)
    """when each process was seen last"""

    def write(self, pids: dict[str, int], at_s: float) -> None:
        """Look at these processes and their children."""
        begins_s, lasts_s = windows(self.total_s)
        kept = any(begin_s <= at_s <= begin_s + lasts_s for begin_s in begins_s)
        for name, pid in pids.items():
            found = [(name, pid)]
            counts: Counter[str] = Counter()
            for child, command in sorted(children(pid).items()) if name != "programs" else ():
                counts[title(command)] += 1
                number = f" {counts[title(command)]}" if counts[title(command)] > 1 else ""
                found.append((f"{name}: {title(command)}{number}", child))
            for called, one in found:
                if (seen := look(one, at_s)) is not None:
                    self.last_s[called] = at_s
                    if kept:
                        self.looks.setdefault(called, []).append(seen)

    def rows(self) -> Iterator[Row]:
        """Yield the comparison of each process that lived in all windows."""
        begins_s, lasts_s = windows(self.total_s)
        for name, looks in self.looks.items():
            parts = [[one for one in looks if begin <= one.at_s <= begin + lasts_s] for begin in begins_s]
            if all(parts):
                yield Row.of(name, parts)


def windows(total_s: float) -> tuple[tuple[float, float, float], float]:
    """Return when the windows begin and how long they are (s), for a soak of this length (s)."""
    lasts_s, first_s = min(WINDOW_S, total_s / 6), min(BEGIN_S, total_s / 6)
    last_s = total_s - lasts_s
    return (first_s, (first_s + last_s) / 2, last_s), lasts_s


@dataclass(frozen=True)
class Row:
    """A process in the windows: memory in all, the numbers in the first and the last."""

    name: str
    rss_mib: tuple[float, ...]
    own_mib: tuple[float, ...]
    descriptors: tuple[int, int]
    threads: tuple[int, int]
    cpu: float
    """share of a core in the last window"""

    @classmethod
    def of(cls, name: str, parts: list[list[Look]]) -> Row:
        """Compare medians of memory and of the numbers."""
        first, last = parts[0], parts[-1]
        pairs = [(early, late) for early, late in pairwise(last) if early.pid == late.pid]
        lasted_s = sum(late.at_s - early.at_s for early, late in pairs)
        return cls(
            name,
            tuple(median(one.rss_mib for one in part) for part in parts),
            tuple(median(one.own_mib for one in part) for part in parts),
            (median_high(one.descriptors for one in first), median_high(one.descriptors for one in last)),
            (median_high(one.threads for one in first), median_high(one.threads for one in last)),
            sum(late.cpu_s - early.cpu_s for early, late in pairs) / lasted_s if pairs else 0.0,
        )

    @property
    def growth(self) -> float:
        """Growth of the resident memory as a share."""
        return self.rss_mib[-1] / self.rss_mib[0] - 1

    def faults(self) -> list[str]:
        """Return what grows, as sentences."""
        found = []
        if self.growth > GROWTH and self.rss_mib[-1] - self.rss_mib[0] > NOISE_MIB:
            found.append(f"{self.name}: memory grows by {self.growth:.1%}")
        found += [
            f"{self.name}: {what} grow from {before} to {after}"
            for what, (before, after) in (("descriptors", self.descriptors), ("threads", self.threads))
            if after > before + MORE
        ]
        return found

    def cells(self) -> tuple[str, ...]:
        """Return the row as text."""
        return (
            self.name,
            " → ".join(f"{one:.1f}" for one in self.rss_mib),
            f"{self.growth:+.1%}",
            " → ".join(f"{one:.1f}" for one in self.own_mib),
            " → ".join(map(str, self.descriptors)),
            " → ".join(map(str, self.threads)),
            f"{self.cpu:.0%}",
        )


HEADS: Final = (
    "process",
    "memory [MiB]",
    "growth",
    "of no file [MiB]",
    "descriptors",
    "threads",
    "of a core",
)


def table(heads: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    """Return a table in Markdown."""
    lines = [heads, tuple("---" for _ in heads), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def machine() -> str:
    """Return processor, cores, memory, system and versions of this computer as a sentence."""
    text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    names = [line.partition(":")[2].strip() for line in text.splitlines() if line.startswith("model name")]
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    processor = names[0] if names else platform.machine()
    return (
        f"{processor}, {os.cpu_count()} cores, {memory:.0f} GiB, {platform.system()} {platform.release()}, "
        f"Python {platform.python_version()}, {datetime.now(UTC):%Y-%m-%d}"
    )


def page(
    rows: list[Row],
    others: Iterable[tuple[tuple[str, ...], list[tuple[str, ...]]]],
    faults: list[str],
    hours: float,
) -> str:
    """Return the page: the processes, other tables (heads, rows), and what is wrong."""
    (first_s, middle_s, last_s), lasts_s = windows(hours * 3600)
    head = f"""# Soak

Written by `make soak`, never by hand. Both robots, a page with clients, recorders with and without pictures, random
previews and commits, STOPs, and a router that is restarted. {hours:.2f} hours on {machine()}.

Memory is the median of {lasts_s / 60:.1f} minutes each from minute {first_s / 60:.1f}, {middle_s / 60:.1f} and {last_s / 60:.1f}; the other numbers compare the first with the last. The
router is restarted once before, so that what a process loads when it connects again is not called growth.

"""
    parts = [head, table(HEADS, (row.cells() for row in rows))]
    for heads, cells in others:
        parts += ["\n", table(heads, cells)]
    found = (
        "".join(f"- {fault}\n" for fault in faults)
        or f"Nothing: no process grows by more than {GROWTH:.0%}.\n"
    )
    meaning = f"""
## What is wrong

Memory that grows by more than {GROWTH:.0%} and {NOISE_MIB:.0f} MiB, more than {MORE} descriptors or threads in addition, and what has failed.
A leak grows for as long as a process runs; memory that is used once and kept does not. A longer soak tells them apart.

"""
    return "".join([*parts, meaning, found])
