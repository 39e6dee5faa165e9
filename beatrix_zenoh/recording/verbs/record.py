"""`beatrix record`: record robots into a recording, or one robot into a motion file."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from beatrix_zenoh import memory
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.files import check_new
from beatrix_zenoh.output import FAILED, exit_code, note, print_json, say, typed
from beatrix_zenoh.recording.losses import PICTURES, Count, Stream, findings, total
from beatrix_zenoh.recording.verbs.files import RECORDING, repair_recording
from beatrix_zenoh.recording.verbs.view import leave, open_viewer
from beatrix_zenoh.recording.viewer import PORT, program
from beatrix_zenoh.settings import Settings, resolve
from beatrix_zenoh.shutdown import POLL_S, Shutdown
from beatrix_zenoh.terminal.options import Cameras, Connect, Json, Names, On, ViewerPort, Which, Who, finite
from beatrix_zenoh.terminal.targets import open_robots

if TYPE_CHECKING:  # importing numpy and rerun would delay every verb
    from beatrix_zenoh.recording.outputs import FileOutput, Output
    from beatrix_zenoh.recording.recorder import Recorder, RecordingOptions
    from beatrix_zenoh.recording.viewer import Viewer

MOTION_FILE = ".csv"
SHORTEST_MIN = 0.1
"""Shortest file of a rotated recording, minutes."""

File = Annotated[
    Path, typer.Argument(metavar="FILE", help="The recording (.rrd), or the motion file (.csv).")
]


def rotation(minutes: float) -> float:
    """Return the value of --rotate; raises BadParameter unless it is 0 or at least SHORTEST_MIN."""
    if finite(minutes) == 0 or minutes >= SHORTEST_MIN:
        return minutes
    raise typer.BadParameter(
        f"{minutes:g} minutes are too short for a file: give {SHORTEST_MIN:g} or more, or 0 for one file."
    )


Seconds = Annotated[
    float,
    typer.Option(
        min=0.0, metavar="S", callback=finite, help="Stop after this many seconds; 0: record until Ctrl-C."
    ),
]
Rotate = Annotated[
    float,
    typer.Option(
        min=0.0,
        metavar="MINUTES",
        callback=rotation,
        help="Length of each file, 0.1 or more; 0: one file.",
    ),
]
View = Annotated[bool, typer.Option("--view", help="Also show the robots in the viewer.")]
Motion = Annotated[
    bool, typer.Option("--motion", help="Write a motion file (.csv) of one robot, for `beatrix replay`.")
]
Microphones = Annotated[
    bool,
    typer.Option(
        "--sound",
        help="Also record what the microphones hear, and so every person who speaks: ask them first.",
    ),
]
Title = Annotated[str, typer.Option(help="Title of the recording; default: the name of the file.")]
Remark = Annotated[str, typer.Option("--note", metavar="TEXT", help="A remark about the whole recording.")]
KeepRest = Annotated[
    bool, typer.Option("--keep-rest", help="With --motion: keep long rests at start and end of the file.")
]
Repair = Annotated[
    bool, typer.Option("--repair", help="Repair FILE.rrd, whose recorder was killed; records nothing.")
]


def record(
    file: File,
    name: Names = None,
    seconds: Seconds = 0.0,
    rotate: Rotate = 0.0,
    cameras: Cameras = 5.0,
    sound: Microphones = False,
    title: Title = "",
    remark: Remark = "",
    view: View = False,
    port: ViewerPort = PORT,
    motion: Motion = False,
    keep_rest: KeepRest = False,
    on: On = None,
    repair: Repair = False,
    connect: Connect = None,
    who: Who = None,
    as_json: Json = False,
) -> None:
    """Record robots for the Rerun viewer.

    The recording contains arms and heads of simulation and robot on one time line, their difference, states, requests,
    refusals and pictures. Robots may start and end during the recording. `beatrix view FILE.rrd` shows it.
    """
    if motion:
        if sound:
            raise typer.BadParameter("--sound needs a recording (.rrd): a motion file contains no sound.")
        write_motion(file, name or (), connect, who, on, seconds, keep_rest=keep_rest, as_json=as_json)
        return
    if on is not None:
        raise typer.BadParameter("--on needs --motion: a recording contains both simulation and hardware.")
    if keep_rest:
        raise typer.BadParameter("--keep-rest needs --motion: a recording contains all rests.")
    if file.suffix != RECORDING:
        raise typer.BadParameter(
            f"{file} is not the name of a recording: it must end with {RECORDING}. A motion file for `beatrix replay` needs "
            "--motion; `beatrix export` makes tables, films and sounds of a recording."
        )
    if repair:
        repair_recording(file, as_json=as_json)
        return
    program()  # raises before any file is written
    from beatrix_zenoh.recording.recorder import RecordingOptions

    robots = [names.check_name(robot) for robot in name or []]
    options = RecordingOptions(robots, cameras, sound, title, remark)
    settings = resolve(None, connect, who)
    write_recording(settings, file, options, seconds, rotate * 60, port if view else None, as_json=as_json)


def write_recording(
    settings: Settings,
    path: Path,
    options: RecordingOptions,
    seconds: float,
    rotate_s: float,
    viewer_port: int | None,
    *,
    as_json: bool,
) -> None:
    """Record, print a summary, and end the verb with its exit code.

    Args:
        settings: of the session.
        path: name of the recording.
        options: what is recorded.
        seconds: length; 0: until Ctrl-C.
        rotate_s: length of each file (s); 0: one file.
        viewer_port: None: no viewer.
        as_json: whether the summary is JSON.

    Raises:
        Refused: BAD_VALUE, the file exists already or cannot be written, or Rerun is not installed.
        NoAnswer: NO_ROUTER.
    """
    from beatrix_zenoh.recording.outputs import FileOutput, LiveOutput
    from beatrix_zenoh.recording.recorder import start_recording

    shutdown = Shutdown()
    shutdown.handle_signals()
    with Client(settings, announce=False) as client:
        file = FileOutput(path, note, rotate_s=rotate_s)
        outputs: list[Output] = [file]
        viewer: Viewer | None = None
        if viewer_port is not None:
            viewer = viewer_if_possible(viewer_port)
            outputs.append(LiveOutput(viewer_port, note))
        recorder = start_recording(client, outputs, note, options, lambda: file.files[-1].name)
        began_s = time.monotonic()
        try:
            if not as_json:
                say(f"ready {file.files[0]}")
            wait(recorder, shutdown, seconds, file)
        finally:
            lasted_s = time.monotonic() - began_s
            closed = recorder.close()
            if viewer is not None:
                viewer.end()
    leave(summarise(recorder, file, lasted_s, as_json=as_json), closed=closed)


def viewer_if_possible(port: int) -> Viewer | None:
    """Start a viewer and return it; return None if a viewer is open already, or none can be started (prints a note)."""
    try:
        return open_viewer(port)
    except BeatrixError as error:
        note(f"{error.message} The recording continues without it.")
        return None


def wait(recorder: Recorder, shutdown: Shutdown, seconds: float, output: FileOutput) -> None:
    """Wait for a shutdown request, the end of the time, or a full disk; print a note for each new robot."""
    known: list[tuple[str, str]] = []
    memory.keep_loaded()
    deadline_s = time.monotonic() + seconds if seconds else float("inf")
    while not output.full and time.monotonic() < deadline_s:
        if shutdown.requested(min(POLL_S, max(0.0, deadline_s - time.monotonic()))):
            return
        recorder.check()
        for place in recorder.robots:
            if place not in known:
                known.append(place)
                note(f"Recording {place[0]} ({place[1]}).")


def write_motion(
    file: Path,
    names: Sequence[str],
    connect: str | None,
    who: str | None,
    on: Which | None,
    seconds: float,
    *,
    keep_rest: bool,
    as_json: bool,
) -> None:
    """Record one robot into a motion file until a signal, or for `seconds` (0: no limit), and print a summary."""
    from beatrix_zenoh.recording.record_motion import record_motion

    if file.suffix != MOTION_FILE:
        raise typer.BadParameter(f"{file} is not the name of a motion file: it must end with {MOTION_FILE}.")
    if len(names) > 1 or on is Which.BOTH:
        raise typer.BadParameter("--motion records one robot: give one --name, and --on sim or --on hw.")
    check_new(file)
    with open_robots(resolve(names[0] if names else None, connect, who), on) as (robot,):
        shutdown = Shutdown()
        shutdown.handle_signals()
        note(f"Recording {robot} into {file}. Move the robot; Ctrl-C ends the recording.")
        deadline_s = time.monotonic() + seconds if seconds else float("inf")

        def going() -> bool:
            return time.monotonic() < deadline_s and not shutdown.requested(0.0)

        points = record_motion(robot, file, keep_rest=keep_rest, going=going)
    if as_json:
        print_json(
            {"result": True, "file": str(file), "robot": robot.name, "side": robot.side, "points": points}
        )
    else:
        say(f"{file}: {points} points. To replay it: {typed('beatrix', 'replay', file)}")


def summarise(recorder: Recorder, output: FileOutput, lasted_s: float, *, as_json: bool) -> int:
    """Print a summary of the recording, and return the exit code."""
    robots = [f"{name} ({side})" for name, side in recorder.robots]
    good, counts = bool(robots) and not output.full, recorder.counts
    whole = total(counts)
    if as_json:
        print_json({
            "result": good,
            "files": [str(path) for path in output.files],
            "robots": robots,
            "seconds": round(lasted_s, 2),
            "positions": recorder.samples,
            **outcome(whole),
            "streams": [
                {"robot": name, "side": side, "stream": what, "published": one.published, **outcome(one)}
                for ((name, side), what), one in counts.items()
            ],
            "bytes": output.bytes,
        })  # fmt: skip
    elif robots:
        files = ", ".join(map(str, output.files))
        for text in findings(counts).values():
            note(text)
        say(
            f"{files}: {lasted_s:.1f} s of {', '.join(robots)}, {recorder.samples} positions, {missing(counts)}, "
            f"{output.bytes / 1e6:.1f} MB. To view it: {typed('beatrix', 'view', output.files[-1])}"
        )
    else:
        note("No robot was online: the recording is empty. `beatrix ls` shows the robots online.")
    if not robots:
        return exit_code(Reason.NO_ANSWER)
    return 0 if good else FAILED


def outcome(one: Count) -> dict[str, int | None]:
    """Return what became of publications, as data; None: unknown."""
    lost = None if one.contested else one.lost
    return {"lost": lost, "dropped": one.unwritten, "late": one.late, "repeated": one.repeated}


def missing(counts: Mapping[Stream, Count]) -> str:
    """Return how many publications the recording lacks, in words; pictures apart, because routers leave them out."""
    pictures = {stream: one for stream, one in counts.items() if stream[1].startswith(PICTURES)}
    whole = total({stream: one for stream, one in counts.items() if stream not in pictures})
    words = {
        "lost on the network": whole.lost,
        "pictures did not arrive": total(pictures).lost,
        "dropped": total(counts).unwritten,
    }
    known = [f"{number} {what}" for what, number in words.items() if number]
    if whole.contested:
        known.append("losses unknown, because two programs publish")
    return ", ".join(known) or "nothing dropped"
