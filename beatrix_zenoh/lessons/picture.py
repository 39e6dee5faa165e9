"""The picture of a check, what was asked against what was done, as SVG: browsers, viewers and Qt show it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from typing import Final

import numpy as np

from beatrix_zenoh.lessons.measures import Curve

WIDTH, HEIGHT, LEFT, TOP, GAP = 720, 150, 56, 34, 34
"""Of the picture, and of each panel; margins, and the space below a panel (px)."""
ASKED, DONE, LINE = "#1a8a3c", "#0a5fb4", "#888"
POINTS: Final = 300
"""Most points of a curve."""
WORDS: Final = {"en": ("asked", "done", "time (s)"), "de": ("verlangt", "getan", "Zeit (s)")}


@dataclass(frozen=True)
class Panel:
    """One quantity over time."""

    label: str
    """quantity and unit"""
    t: Curve
    """s"""
    done: Curve
    asked: Curve | None = None
    """at the same times"""
    zones: tuple[tuple[float, float], ...] = ()
    """where the curve must come to, or stay: from, to; they may be infinite"""


def svg(panels: Sequence[Panel], language: str) -> str:
    """Return the picture; it needs at least one panel."""
    asked, done, time = WORDS[language]
    height = TOP + len(panels) * (HEIGHT + GAP)
    size = f'width="{WIDTH}" height="{height}" viewBox="0 0 {WIDTH} {height}"'
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" font-size="14">',
        f'<rect width="{WIDTH}" height="{height}" fill="#fff"/>',
        _text(LEFT, 20, f"■ {asked}", ASKED),
        _text(LEFT + 120, 20, f"━ {done}", DONE),
        _text(WIDTH - 10, 20, time, "#333", "end"),
    ]
    for number, panel in enumerate(panels):
        parts += _drawn(panel, TOP + number * (HEIGHT + GAP))
    return "\n".join((*parts, "</svg>\n"))


def _text(x: float, y: float, text: str, colour: str, anchor: str = "start") -> str:
    return f'<text x="{x:.0f}" y="{y:.0f}" fill="{colour}" text-anchor="{anchor}">{escape(text)}</text>'


def _drawn(panel: Panel, top: int) -> Iterator[str]:
    """Yield the elements of a panel whose upper edge is at `top` (px)."""
    values = np.concatenate(
        (panel.done, [0.0] if panel.asked is None else panel.asked, np.ravel(panel.zones))
    )
    values = values[np.isfinite(values)]
    margin = 0.12 * max(float(np.ptp(values)), 1.0)
    low, high = float(values.min()) - margin, float(values.max()) + margin
    begin, end = float(panel.t[0]), max(float(panel.t[-1]), float(panel.t[0]) + 0.1)

    def at(t: float, value: float) -> tuple[float, float]:
        x = LEFT + (t - begin) / (end - begin) * (WIDTH - LEFT - 10)
        return x, top + (high - min(max(value, low), high)) / (high - low) * HEIGHT

    def line(curve: Curve, look: str) -> str:
        every = -(-len(curve) // POINTS)
        samples = zip(panel.t[::every], curve[::every], strict=True)
        points = (at(t, value) for t, value in samples if np.isfinite(value))
        return f'<polyline fill="none" {look} points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in points)}"/>'

    for zone in panel.zones:
        (x, below), (right, above) = at(begin, zone[0]), at(end, zone[1])
        size = f'width="{right - x:.1f}" height="{below - above:.1f}"'
        yield f'<rect x="{x:.1f}" y="{above:.1f}" {size} fill="{ASKED}" fill-opacity="0.2"/>'
    for value in _ticks(low, high):
        (x, y), (right, _) = at(begin, value), at(end, value)
        yield f'<line x1="{x:.1f}" y1="{y:.1f}" x2="{right:.1f}" y2="{y:.1f}" stroke="#ddd"/>'
        yield _text(LEFT - 6, y + 5, f"{value:g}", "#333", "end")
    for t in _ticks(begin, end):
        yield _text(at(t, low)[0], top + HEIGHT + 18, f"{t:g}", "#333", "middle")
    yield f'<rect x="{LEFT}" y="{top}" width="{WIDTH - LEFT - 10}" height="{HEIGHT}" fill="none" stroke="{LINE}"/>'
    if panel.asked is not None:
        yield line(panel.asked, f'stroke="{ASKED}" stroke-width="3" stroke-dasharray="8 5"')
    yield line(panel.done, f'stroke="{DONE}" stroke-width="2"')
    yield _text(LEFT + 8, top + 18, panel.label, "#000")


def _ticks(low: float, high: float) -> list[float]:
    """Return three to eight round numbers of a range."""
    step = 10.0 ** np.floor(np.log10((high - low) / 3))
    step *= next(one for one in (5, 2, 1) if (high - low) / (one * step) >= 3)
    return [round(float(one), 6) + 0.0 for one in np.arange(np.ceil(low / step) * step, high, step)]
