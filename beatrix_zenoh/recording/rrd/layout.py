"""The viewer's tabs: overlay of both sides, both side by side, plots, and log with states."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import rerun.blueprint as rrb
from rerun.blueprint.encodings import TextLogColumn, TimelineColumn

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.colours import STYLES
from beatrix_zenoh.contract.names import SIDE_TITLES
from beatrix_zenoh.recording.rows import RobotSet, of_difference, of_robot
from beatrix_zenoh.recording.rrd.columns import TIME
from beatrix_zenoh.recording.rrd.scene import MECHANISM, solids_of

WINDOW_S: Final = 20.0
"""Time span of plots and states."""
BACKGROUND: Final = (236, 239, 243)
EYE: Final = (0.437, -0.266, 0.124)
"""Position of the viewpoint (m): in front of the head, to its right."""
ROBOT_SHARE: Final = 3
"""Share of the width for a robot, which is tall and narrow, beside EYES_SHARE for the pictures of its eyes."""
EYES_SHARE: Final = 2
CENTRE: Final = (0.0, 0.0, 0.005)
TABS: Final = ("Overlay", "Side by side", "Plots", "Log")
"""Titles of the tabs, which pages use, too."""
ARMS_DEG: Final = (-60.0, 60.0)
HEAD_DEG: Final = (-60.0, 60.0)
APART_DEG: Final = (-2.0, 2.0)
SOUND: Final = "Sound"
"""Title of the tab that a recording with sound has in addition."""
AMPLITUDE: Final = (-0.5, 0.5)
LEVEL_DB: Final = (-90.0, 0.0)

Part = rrb.Container | rrb.View


def layout(shown: RobotSet) -> rrb.Blueprint:
    """Return the layout for these robots."""
    overlays = [overlay(shown, name) for name in shown.names]
    besides = [beside(shown, name) for name in shown.names]
    plots = [plots_of(shown, name) for name in shown.names]
    sounds = [sound_of(place) for place in sorted(shown.with_sound)]
    return rrb.Blueprint(
        rrb.Tabs(
            tiled(overlays, TABS[0]),
            tiled(besides, TABS[1]),
            # The plots of one robot fill a screen, so each of several robots gets a tab of its own.
            rrb.Tabs(*plots, name=TABS[2]) if len(plots) > 1 else tiled(plots, TABS[2]),
            rrb.Vertical(states(), log(), row_shares=[1, 3], name=TABS[3]),
            *([tiled(sounds, SOUND)] if sounds else []),
            active_tab=0,
        ),
        rrb.TimePanel(state="collapsed", timeline=TIME, play_state="following"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TopPanel(state="expanded"),
        auto_layout=False,
        auto_views=False,
    )


def tiled(parts: Sequence[Part], name: str) -> rrb.Container:
    """Return one tab that contains these parts."""
    return rrb.Grid(*parts, name=name) if len(parts) > 1 else rrb.Horizontal(*parts, name=name)


def overlay(shown: RobotSet, name: str) -> rrb.View:
    """Return a view of the hardware with the simulation as a ghost over it, or of the only side."""
    sides = shown.sides(name)
    contents = []
    for place in sides:
        ghost = place[1] == "sim" and len(sides) > 1
        contents += [f"+ {path}" for path in solids_of(place, "ghost" if ghost else "solid")]
    title = f"{name}: hardware, and the simulation as a blue ghost" if len(sides) > 1 else titled(sides[0])
    return scene_view(f"/{name}", contents, title, sides)


def beside(shown: RobotSet, name: str) -> rrb.Container:
    """Return views of both sides in the middle, and beside each the pictures of its eyes."""
    columns: list[Part] = []
    shares = []
    for place in shown.sides(name):
        contents = [f"+ {path}" for path in solids_of(place, "solid")]
        columns.append(scene_view("/" + of_robot(place), contents, titled(place), [place]))
        shares.append(ROBOT_SHARE)
        if place in shown.with_pictures:
            outside = 0 if place[1] == "sim" else len(columns)
            columns.insert(outside, rrb.Vertical(*(eye_view(place, eye) for eye in ("left", "right"))))
            shares.insert(outside, EYES_SHARE)
    return rrb.Horizontal(*columns, column_shares=shares, name=name)


def scene_view(origin: str, contents: Sequence[str], title: str, places: Sequence[Place]) -> rrb.View:
    """Return a 3D view from a fixed viewpoint; the mechanism of these robots is in it, hidden at first."""
    inside = [f"/{of_robot(place, MECHANISM)}" for place in places]
    return rrb.Spatial3DView(
        origin=origin,
        contents=[*contents, *(f"+ {path}/**" for path in inside)],
        overrides={path: rrb.EntityBehavior(visible=False) for path in inside},
        name=title,
        background=BACKGROUND,
        line_grid=False,
        eye_controls=rrb.EyeControls3D(position=EYE, look_target=CENTRE, eye_up=(0.0, 0.0, 1.0)),
    )


def eye_view(place: Place, eye: str) -> rrb.View:
    """Return a view of the pictures of one eye."""
    return rrb.Spatial2DView(
        origin="/" + of_robot(place, "camera", eye), name=f"{eye} eye, {SIDE_TITLES[place[1]]}"
    )


def plots_of(shown: RobotSet, name: str) -> rrb.Container:
    """Return plots of arms and head, and with both sides also of the difference between hardware and simulation."""
    sides = shown.sides(name)
    styles = f": {STYLES}" if len(sides) > 1 else ""
    # Two plots share the screen's height; with more the viewer would leave out the numbers on their axes.
    curves = rrb.Vertical(
        plot([of_robot(place, "arms") for place in sides], f"arms (°){styles}", ARMS_DEG),
        plot([of_robot(place, "head") for place in sides], f"head (°){styles}", HEAD_DEG),
    )
    if len(sides) == 1:
        return rrb.Horizontal(curves, name=name)
    apart = rrb.Vertical(
        plot([of_difference(name, "arms")], "arms: hardware − simulation (°)", APART_DEG),
        plot([of_difference(name, "head")], "head: hardware − simulation (°)", APART_DEG),
    )
    return rrb.Horizontal(curves, apart, column_shares=[3, 2], name=name)


def sound_of(place: Place) -> rrb.Container:
    """Return plots of what a robot hears: the waveform, and the level of both ears."""
    path = of_robot(place, "microphones")
    return rrb.Vertical(
        plot([f"{path}/wave"], f"{titled(place)}, left ear up, right ear down (1 is full scale)", AMPLITUDE),
        plot(
            [f"{path}/level"],
            f"{titled(place)}, level (0 dB is full scale)",
            LEVEL_DB,
            rrb.Corner2D.LeftBottom,  # below the noise of the ears
        ),
        name=place[0],
    )


def plot(
    paths: Sequence[str],
    title: str,
    span: tuple[float, float],
    legend: rrb.Corner2D = rrb.Corner2D.LeftTop,
) -> rrb.View:
    """Return a plot of curves over 20 s, with a fixed vertical axis."""
    return rrb.TimeSeriesView(
        origin="/",
        contents=[f"+ /{path}" for path in paths],
        name=title,
        axis_x=recent(),
        axis_y=rrb.ScalarAxis(range=span),
        plot_legend=rrb.PlotLegend(corner=legend),
        background=None,
    )


def recent() -> rrb.TimeAxis:
    """Return a time axis over the last 20 s."""
    return rrb.TimeAxis(
        view_range=rrb.TimeRange(
            start=rrb.TimeRangeBoundary.cursor_relative(seconds=-WINDOW_S),
            end=rrb.TimeRangeBoundary.cursor_relative(seconds=0.5),
        )
    )


def states() -> rrb.View:
    """Return a view of the states of all robots as bars."""
    return rrb.StateTimelineView(origin="/", contents="/**", name="states", time_view=recent())


def log() -> rrb.View:
    """Return a log of the requests, refusals, STOPs and warnings of all robots."""
    return rrb.TextLogView(
        origin="/",
        contents="/**",
        name="requests, replies and refusals",
        # Time and robot are part of the text, because their columns would be too narrow.
        columns=rrb.TextLogColumns(
            timeline_columns=[TimelineColumn(TIME, visible=False)],
            text_log_columns=[TextLogColumn("LogLevel"), TextLogColumn("Body")],
        ),
    )


def titled(place: Place) -> str:
    """Return the title of a robot."""
    return f"{place[0]}: {SIDE_TITLES[place[1]]}"
