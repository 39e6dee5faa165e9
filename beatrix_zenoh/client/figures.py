"""Figures of angles over time. matplotlib is imported where a figure is made; no display is needed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from beatrix_zenoh.colours import ARMS, AXES, hexadecimal
from beatrix_zenoh.contract.errors import wrong_usage

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Figure  # noqa: PLC0414 - other modules name it

WIDTH_IN = 10.0
"""Width of figures (inches)."""
Curves = Mapping[str, Iterable[float]]
"""Angles (deg) by the name of the arm or axis."""


def time_figure(
    t: Iterable[float], arms: Curves, head: Curves, dashed: tuple[Curves, Curves] = ({}, {})
) -> Figure:
    """Return a figure of arms and head (deg) over time (s); `dashed` are the commanded angles of both.

    Raises:
        WrongUsage: BAD_VALUE, the package matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure  # noqa: PLC0415  # only where a figure is made
    except ModuleNotFoundError as error:
        text = "plot() needs the package matplotlib, which `beatrix install plot` installs."
        raise wrong_usage(text) from error
    figure = Figure(figsize=(WIDTH_IN, 5.5), layout="constrained")
    panels = figure.subplots(2, 1, sharex=True)
    parts = ("arms", arms, dashed[0], ARMS), ("head", head, dashed[1], AXES)
    for panel, (name, curves, commanded, colours) in zip(panels, parts, strict=True):
        for axis, angles in curves.items():
            panel.plot(t, angles, color=hexadecimal(colours[axis]), label=axis)
        for axis, angles in commanded.items():
            panel.plot(t, angles, color=hexadecimal(colours[axis]), linestyle="--", linewidth=1)
        label_panel(panel, f"{name} (°)")
    panels[-1].set_xlabel("time (s), dashed: commanded" if any(dashed) else "time (s)")
    return figure


def label_panel(panel: Axes, label: str) -> None:
    """Add label, grid and legend to a panel."""
    panel.set_ylabel(label)
    panel.grid(alpha=0.25)
    panel.spines[["top", "right"]].set_visible(False)
    panel.margins(x=0.01)
    panel.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
