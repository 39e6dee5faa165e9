"""The static data of a recording (solids, curves, colours of states), and the viewer's tabs that show them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.encodings import TextLogColumn, TimelineColumn

from beatrix_zenoh.body.figure import Figure, mechanism, meshes
from beatrix_zenoh.body.surface import Mesh, triangles
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.colours import ARMS, AXES, STYLES, Colour, pale
from beatrix_zenoh.contract.names import SIDE_TITLES
from beatrix_zenoh.recording.rows import BarState, RobotSet, of_difference, of_model, of_robot
from beatrix_zenoh.recording.rrd.columns import TIME

Item = tuple[str, rr.AsComponents]
"""Path of an entity and its components."""

MECHANISM = "mechanism"
"""Entity of a robot below which the mechanism is drawn."""
GHOST = (20, 120, 255, 120)
"""Colour and opacity of the simulation over the hardware."""
THINNER_M = 0.0005
"""By how much (m) the ghost is smaller than the solid, because coincident surfaces would flicker."""
CURVES = {"arms": ARMS, "commanded": ARMS, "velocity": ARMS, "head": AXES, "head_measured": AXES}
"""Colours of the curves of an entity, by their names."""
EARS = {"left": AXES["yaw"], "right": AXES["roll"]}
"""Colours of the curves of both ears."""
LEVEL_WIDTHS = (6.0, 2.0)
"""Widths (points) of the levels of the left and the right ear: equal ones cover each other."""
STATES = {
    BarState.DISABLED: ("○", (120, 125, 130)),
    BarState.ENABLED: ("◐", (214, 190, 80)),
    BarState.READY: ("●", (70, 150, 90)),
    BarState.MOVING: ("▶", (60, 130, 230)),
    BarState.FOLLOWING: ("»", (40, 160, 170)),
    BarState.PARTED: ("≠", (225, 80, 110)),
    BarState.STOPPED: ("■", (235, 140, 40)),
    BarState.EMERGENCY: ("✖", (215, 45, 45)),
    BarState.FAULT: ("⚠", (170, 50, 160)),
    BarState.LOST: ("?", (60, 62, 66)),
}
"""Sign and colour of each state; the signs remain when the viewer cuts the word of a short state."""


def of_place(place: Place, figure: Figure) -> Iterator[Item]:
    """Yield the items of one robot that stay the same for a whole recording.

    These are its solids, curve styles and state colours.
    """
    for mesh in meshes(figure):
        path = of_model(place, mesh.path)
        yield f"{path}/solid", shape(mesh)
        if place[1] == "sim":
            yield f"{path}/ghost", ghost(mesh)
    yield from inside(place, figure)
    yield from curves(place)
    ears = {f"{ear} ear": colour for ear, colour in EARS.items()}
    yield of_robot(place, "microphones", "wave"), lines(ears, width=2.0)
    levels = {f"{ear}, {width} (dB)": EARS[ear] for ear, width in (("left", "wide"), ("right", "thin"))}
    yield (
        of_robot(place, "microphones", "level"),
        rr.SeriesLines(names=list(levels), colors=list(levels.values()), widths=LEVEL_WIDTHS),
    )
    yield (
        of_robot(place, "state"),
        rr.StateConfiguration(
            values=[state.value for state in STATES],
            labels=[f"{sign} {state.value}" for state, (sign, _) in STATES.items()],
            colors=[colour for _, colour in STATES.values()],
        ),
    )


def inside(place: Place, figure: Figure) -> Iterator[Item]:
    """Yield the mechanism in a tree of its own, so that one switch shows it; its parts move with the model's bodies."""
    for mesh in mechanism(figure):
        path = f"{of_robot(place, MECHANISM)}/{mesh.body}"
        yield path, rr.CoordinateFrame(f"tf#/{of_model(place, mesh.path)}")
        yield path, shape(mesh)


def curves(place: Place) -> Iterator[Item]:
    """Yield names and styles of one robot's curves: the hardware wide, the simulation thin, pale and on top."""
    hardware = place[1] == "hw"
    for what, colours in CURVES.items():
        unit = "°/s" if what == "velocity" else "°"
        label = "" if what in ("arms", "head") else f", {what.removeprefix('head_')}"
        yield (
            of_robot(place, what),
            lines(
                {
                    f"{name}, {SIDE_TITLES[place[1]]}{label} ({unit})": colour if hardware else pale(colour)
                    for name, colour in colours.items()
                },
                width=6.0 if hardware else 2.0,
            ),
        )


def of_name(robot: str) -> Iterator[Item]:
    """Yield the names and styles of the curves of the difference between hardware and simulation."""
    for what in ("arms", "head"):
        named = {f"{name} (°)": colour for name, colour in CURVES[what].items()}
        yield of_difference(robot, what), lines(named, width=2.5)


def lines(colours: dict[str, Colour], width: float) -> rr.SeriesLines:
    """Return the style of curves of one width (points), by their names."""
    return rr.SeriesLines(names=list(colours), colors=list(colours.values()), widths=[width] * len(colours))


def shape(mesh: Mesh) -> rr.Mesh3D:
    """Return a body in its colours."""
    return rr.Mesh3D(
        vertex_positions=mesh.points,
        vertex_normals=mesh.normals,
        vertex_colors=mesh.colours,
        triangle_indices=triangles(mesh.faces),
    )


def ghost(mesh: Mesh) -> rr.Mesh3D:
    """Return a translucent body that is a little thinner."""
    return rr.Mesh3D(
        vertex_positions=mesh.points - mesh.normals * THINNER_M,
        vertex_normals=mesh.normals,
        triangle_indices=triangles(mesh.faces),
        albedo_factor=GHOST,
    )


def solids_of(place: Place, kind: str) -> list[str]:
    """Return Rerun's paths of the shapes of all bodies; `kind` is `solid` or `ghost`."""
    return [f"/{of_model(place, path)}/{kind}" for path in Figure.paths]


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
