"""Benchmark of the head in three dimensions: pictures a second and CPU, drawn by Qt in software."""

from __future__ import annotations

import math
import os
import time
from dataclasses import replace
from typing import Final

os.environ["QT_QPA_PLATFORM"] = "offscreen"

from PyQt5.QtTest import QTest

from gui.console.link.connection import absent
from gui.console.state.intents import HeadOrientation, Theme
from gui.console.state.state import State
from gui.console.state.views import HeadView
from gui.console.state.world import LinkPhase, World
from gui.console.texts import Texts
from gui.window.run import qt_application
from gui.window.widgets.head3d import Head3d
from gui.window.window import PERIOD_MS

SIZES: Final = {"in the window at 1366 x 768": (660, 500), "at 1920 x 1080": (1100, 800)}
SECONDS: Final = 4.0
PICTURES: Final = 60


def view_at(view: HeadView, t_s: float, *, both: bool) -> HeadView:
    """Return the view at a time of a motion: the hardware follows the simulation, 0.5 s later."""
    sim, hw = _moving(t_s), _moving(t_s - 0.5) if both else None
    solid = "hw" if both else "sim"
    return replace(
        view, sim=sim, hw=hw, solid=solid, shown=hw or sim, silent=False, target=_moving(t_s + 0.5)
    )


def _moving(t_s: float) -> HeadOrientation:
    return HeadOrientation(60 * math.sin(t_s), 15 * math.sin(2 * t_s), 10 * math.cos(1.5 * t_s))


def pictures_per_s(head: Head3d, view: HeadView, *, both: bool) -> float:
    """Return how many pictures one core can draw in a second."""
    began_s = time.process_time()
    for number in range(PICTURES):
        head.show_view(view_at(view, number / 20, both=both))
        head.repaint()
    return PICTURES / (time.process_time() - began_s)


def cpu(head: Head3d, view: HeadView) -> tuple[float, float]:
    """Return pictures a second and the share of a core, with views as often as in the window."""
    began_s, spent_s, drawn = time.monotonic(), time.process_time(), 0
    while (t_s := time.monotonic() - began_s) < SECONDS:
        head.show_view(view_at(view, t_s, both=True))
        drawn += 1
        QTest.qWait(max(1, round(PERIOD_MS - (time.monotonic() - began_s - t_s) * 1000)))
    took_s = time.monotonic() - began_s
    return drawn / took_s, (time.process_time() - spent_s) / took_s


def main() -> None:
    """Print the figures for some sizes of the picture."""
    application = qt_application()
    empty = World(
        now_s=0.0,
        phase=LinkPhase.NO_ROUTER,
        endpoint="",
        seat="bench",
        robot="bench",
        sim=absent("bench", "sim"),
        hw=absent("bench", "hw"),
    )
    view = State().view(empty).head
    head = Head3d(Texts("en"))
    head.show_theme(Theme.DARK)
    print(
        "head in three dimensions, drawn in software; robots and target in motion (required: 15/s, CPU < 40 %)"
    )
    for name, size in SIZES.items():
        head.resize(*size)
        head.show()
        QTest.qWait(50)
        one, two = (pictures_per_s(head, view, both=both) for both in (False, True))
        rate, share = cpu(head, view)
        print(f"  {name}: {one:.0f}/s with one robot, {two:.0f}/s with two, on a whole core")
        print(f"    as in the window: {rate:.1f}/s, {share:.0%} of a core")
    head.close()
    del application


if __name__ == "__main__":
    main()
