"""The figure of a previewed path. It imports matplotlib, so callers import it late; it needs no display."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from beatrix_zenoh.client.readings import Path
from beatrix_zenoh.colours import ARMS, AXES, hexadecimal

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH_IN = 10.0


def path_figure(path: Path) -> Figure:
    """Return a figure of a previewed path: arms and head over time."""
    angles = np.array([(*arms, *head) for arms, head in zip(path.arms, path.head, strict=True)])
    figure = Figure(figsize=(WIDTH_IN, 5.5), layout="constrained")
    panels = figure.subplots(2, 1, sharex=True)
    for panel, name, part, colours in zip(
        panels, ("arms", "head"), (slice(0, 3), slice(3, 6)), (ARMS, AXES), strict=True
    ):
        for column, (axis, colour) in zip(angles[:, part].T, colours.items(), strict=True):
            panel.plot(path.t, column, color=hexadecimal(colour), label=axis)
        label_panel(panel, f"{name} (°)")
    panels[-1].set_xlabel("time (s)")
    return figure


def label_panel(panel: Axes, label: str) -> None:
    """Add label, grid and legend to a panel."""
    panel.set_ylabel(label)
    panel.grid(alpha=0.25)
    panel.spines[["top", "right"]].set_visible(False)
    panel.margins(x=0.01)
    panel.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
