"""The static data of a recording: solids of the robots, names and colours of curves, colours of states."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import rerun as rr

from beatrix_zenoh.client.session import Place
from beatrix_zenoh.colours import ARMS, AXES, Colour, pale
from beatrix_zenoh.contract.names import SIDE_TITLES
from beatrix_zenoh.recording.figure import Body, Figure, Form, Solid
from beatrix_zenoh.recording.mechanism import mechanism
from beatrix_zenoh.recording.robot_rows import BarState
from beatrix_zenoh.recording.rows import of_difference, of_model, of_robot

Item = tuple[str, rr.AsComponents]
"""Path of an entity and its components."""

MECHANISM = "mechanism"
"""Entity of a robot below which the mechanism is drawn."""
GHOST = (20, 120, 255, 120)
"""Colour and opacity of the simulation over the hardware."""
THINNER_M = 0.001
"""Difference in thickness (m) of the ghost, because coincident surfaces would flicker."""
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
    for body in figure.bodies:
        path = of_model(place, body.path)
        for form in Form:
            solids = [solid for solid in body.solids if solid.form is form]
            if solids:
                yield f"{path}/solid/{form}", shape(form, solids, [solid.colour for solid in solids])
                if place[1] == "sim":
                    thin = [thinner(solid) for solid in solids]
                    yield f"{path}/ghost/{form}", shape(form, thin, [GHOST] * len(thin))
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
    for body in mechanism(figure):
        for form in Form:
            solids = [solid for solid in body.solids if solid.form is form]
            if solids:
                path = f"{of_robot(place, MECHANISM)}/{body.path.rpartition('/')[2]}/{form}"
                yield path, rr.CoordinateFrame(f"tf#/{of_model(place, body.path)}")
                yield path, shape(form, solids, [solid.colour for solid in solids])


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


def thinner(solid: Solid) -> Solid:
    """Return the solid with each size reduced by THINNER_M, but at most by half."""
    return replace(solid, size=tuple(max(size - THINNER_M, size / 2) for size in solid.size))


def shape(form: Form, solids: Sequence[Solid], colours: Sequence[tuple[int, ...]]) -> rr.AsComponents:
    """Return the components of one entity that shows solids of one form."""
    places = [solid.position for solid in solids]
    turns = [rr.Quaternion(xyzw=solid.quaternion) for solid in solids]
    if form is Form.ELLIPSOID:
        return rr.Ellipsoids3D(
            half_sizes=[solid.size for solid in solids],
            centers=places,
            quaternions=turns,
            colors=colours,
            fill_mode="solid",
        )
    radii, lengths = [solid.size[0] for solid in solids], [solid.size[1] for solid in solids]
    if form is Form.CYLINDER:
        return rr.Cylinders3D(
            radii=radii, lengths=lengths, centers=places, quaternions=turns, colors=colours, fill_mode="solid"
        )
    return rr.Capsules3D(
        radii=radii,
        lengths=lengths,
        translations=places,
        quaternions=turns,
        colors=colours,
        fill_mode="solid",
    )


def solids_of(place: Place, bodies: tuple[Body, ...], kind: str) -> list[str]:
    """Return Rerun's path patterns for the solids of all bodies; `kind` is `solid` or `ghost`."""
    return [f"/{of_model(place, body.path)}/{kind}/**" for body in bodies]
