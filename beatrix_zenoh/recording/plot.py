"""The figure of a comparison. It imports matplotlib, so callers import it late; it needs no display."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from beatrix_zenoh.client.figures import WIDTH_IN, label_panel
from beatrix_zenoh.colours import ALL, STYLES, hexadecimal, pale
from beatrix_zenoh.contract.names import ARMS
from beatrix_zenoh.recording.compare import Comparison
from beatrix_zenoh.recording.series import AXES, Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def twin_figure(found: Comparison, title: str) -> Figure:
    """Return a figure of arms and head of both robots over time, and of the arms' differences with and without lag."""
    t = found.t - found.t[0]
    figure = Figure(figsize=(WIDTH_IN, 8.5), layout="constrained")
    figure.suptitle(title, fontsize=14, x=0.01, ha="left")
    arms, head, apart = figure.subplots(3, 1, sharex=True, height_ratios=(3, 3, 2))
    for panel, name, part in ((arms, "arms", slice(0, 3)), (head, "head", slice(3, 6))):
        draw_both(panel, t, found.first[:, part], found.second[:, part], AXES[part])
        label_panel(panel, f"{name} (°)")
    for i, arm in enumerate(ARMS):
        colour = hexadecimal(ALL[arm])
        apart.plot(t, found.second[:, i] - found.first[:, i], color=colour, linewidth=3, alpha=0.3)
        after = np.where(found.compared, found.second_after[:, i] - found.first[:, i], np.nan)
        apart.plot(t, after, color=colour, linewidth=1, label=arm)
    label_panel(apart, "hardware - simulation (°)")
    apart.set_title(
        "pale: as recorded;  dark: each motion moved by its lead and lag", fontsize=10, loc="left"
    )
    apart.set_xlabel("time (s)")
    arms.set_title(STYLES, fontsize=10, loc="left")
    return figure


def draw_both(panel: Axes, t: Floats, first: Floats, second: Floats, names: Sequence[str]) -> None:
    """Draw the curves of the second wide and those of the first thin and pale on top, so that both remain visible."""
    for column, name in zip(second.T, names, strict=True):
        colour = hexadecimal(ALL[name])
        panel.plot(t, column, color=colour, linewidth=5, label=name, solid_capstyle="round")
    for column, name in zip(first.T, names, strict=True):
        panel.plot(t, column, color=hexadecimal(pale(ALL[name])), linewidth=1.5)
