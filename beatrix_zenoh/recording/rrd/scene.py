"""The static data of a recording: solids of the robots, names and colours of curves, colours of states."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import rerun as rr

from beatrix_zenoh.body.figure import Figure
from beatrix_zenoh.body.shape import mechanism, meshes
from beatrix_zenoh.body.surface import Mesh, triangles
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.colours import ARMS, AXES, Colour, pale
from beatrix_zenoh.contract.names import SIDE_TITLES
from beatrix_zenoh.recording.rows import BarState, of_difference, of_model, of_robot

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
MARK_COLOURS = ((88, 96, 110), (116, 124, 138))
"""Colours of notes on the time line."""
STATE_SIGNS = {
    BarState.DISABLED: "○",
    BarState.ENABLED: "◐",
    BarState.READY: "●",
    BarState.MOVING: "▶",
    BarState.FOLLOWING: "»",
    BarState.PARTED: "≠",
    BarState.STOPPED: "■",
    BarState.EMERGENCY: "✖",
    BarState.FAULT: "⚠",
    BarState.LOST: "?",
}
"""Signs before the words of the states, which remain when the viewer cuts the word of a short state."""
STATE_COLOURS = {
    BarState.DISABLED: (120, 125, 130),
    BarState.ENABLED: (214, 190, 80),
    BarState.READY: (70, 150, 90),
    BarState.MOVING: (60, 130, 230),
    BarState.FOLLOWING: (40, 160, 170),
    BarState.PARTED: (225, 80, 110),
    BarState.STOPPED: (235, 140, 40),
    BarState.EMERGENCY: (215, 45, 45),
    BarState.FAULT: (170, 50, 160),
    BarState.LOST: (60, 62, 66),
}


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
    yield of_robot(place, "clock"), rr.SeriesLines(names=["clock offset (s)", "its largest error (s)"])
    yield (
        of_robot(place, "state"),
        rr.StateConfiguration(
            values=[state.value for state in BarState],
            labels=[f"{STATE_SIGNS[state]} {state.value}" for state in BarState],
            colors=[STATE_COLOURS[state] for state in BarState],
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


def marks(texts: Sequence[str]) -> rr.StateConfiguration:
    """Return the style of notes as bars; neighbours differ a little."""
    colours = [MARK_COLOURS[i % len(MARK_COLOURS)] for i in range(len(texts))]
    return rr.StateConfiguration(values=texts, labels=texts, colors=colours)


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
