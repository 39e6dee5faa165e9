"""The files of `beatrix demo`: table, plot, pictures and recording. A failure leaves no incomplete file."""

from __future__ import annotations

import csv
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

from beatrix_zenoh.contract._generated.messages import Positions
from beatrix_zenoh.contract.errors import BeatrixError, Refused
from beatrix_zenoh.files import replace_when_complete
from beatrix_zenoh.output import note
from beatrix_zenoh.processes import Child, Supervisor
from beatrix_zenoh.recording.compare import Comparison
from beatrix_zenoh.recording.series import AXES
from beatrix_zenoh.settings import Settings

RECORDING = "demo.rrd"
SIDE_BY_SIDE = 1
"""Number of the viewer's tab that the picture shows."""
PICTURE_S = 30.0
HEAD_POSE = (-35.0, 4.0, 10.0)
"""Yaw, pitch and roll of the head in the picture (deg): it faces the camera."""
DRAW = """
import math, sys
from pathlib import Path
from beatrix_zenoh.motion.kinematics import Neck
from sim_node.picture import write_picture
write_picture(Path(sys.argv[1]), Neck().inverse(*(math.radians(float(angle)) for angle in sys.argv[2:])))
"""

Write = Callable[[Path], None]
"""A function that writes a file to the path given; raises OSError, or Unavailable."""


class Unavailable(Exception):
    """Raised if a file cannot be drawn on this computer; the demo continues without it."""


class Files(NamedTuple):
    """Paths of the files that were written, and a sentence for each file that could not be written."""

    written: list[str]
    failures: list[str]


def write_files(out: Path, found: Comparison, more: Mapping[str, Write]) -> Files:
    """Write the files, and those of `more` by name; print a note for each that this computer cannot draw."""
    writers: dict[str, Write] = {
        "demo.csv": lambda path: write_csv(path, found),
        "demo.png": lambda path: write_plot(path, found),
        "head.png": write_picture,
        **more,
    }
    files = Files([], [])
    for name, write in writers.items():
        try:
            with replace_when_complete(out / name) as unfinished:
                write(unfinished)
        except OSError as error:
            files.failures.append(f"{out / name} could not be written: {error.strerror or error}.")
        except Unavailable as error:
            note(f"The demo continues without {name}: {error}")
        else:
            files.written.append(str(out / name))
    return files


def write_csv(path: Path, found: Comparison) -> None:
    """Write both movements as CSV, a row every 10 ms (deg); raises OSError."""
    names = [f"{robot}_{axis}_deg" for robot in ("sim", "hw") for axis in AXES]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["t_s", *names])
        for t, sim, hw in zip(found.t - found.t[0], found.first, found.second, strict=True):
            writer.writerow([f"{t:.3f}", *(f"{angle:.4f}" for angle in (*sim, *hw))])


def write_plot(path: Path, found: Comparison) -> None:
    """Plot both movements; raises OSError, or Unavailable without matplotlib."""
    try:
        from beatrix_zenoh.recording.plot import twin_figure
    except ModuleNotFoundError as error:
        raise Unavailable(
            f'it needs {error.name}. Run `pip install ".[plot]"` in the folder of BEATRIX.'
        ) from error
    twin_figure(found, "One movement, two robots").savefig(path, dpi=150)


def write_picture(path: Path) -> None:
    """Draw the simulated head in a subprocess; raises OSError, or Unavailable with the reason."""
    command = [sys.executable, "-c", DRAW, str(path), *map(str, HEAD_POSE)]
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PICTURE_S, check=False
        )
    except subprocess.TimeoutExpired:
        raise Unavailable(f"it was not drawn within {PICTURE_S:.0f} s.") from None
    if done.returncode != 0:
        raise Unavailable((done.stderr.strip().splitlines() or ["The reason is not known."])[-1])


class DemoRecording:
    """A recorder that runs until `finish`.

    Its file is in the supervisor's folder, which is deleted when the supervisor ends.
    """

    def __init__(self, supervisor: Supervisor, settings: Settings) -> None:
        """Start the recorder; raises Refused if Rerun is not installed."""
        from beatrix_zenoh.recording.viewer import program

        program()
        self._supervisor = supervisor
        self._path = supervisor.folder / RECORDING
        words = ("record", str(self._path), "--name", settings.robot, "--connect", settings.connect)
        self._recorder: Child = supervisor.start("recorder", *words)
        supervisor.wait_ready()

    def finish(self) -> None:
        """End the recorder, which completes the file."""
        self._supervisor.finish(self._recorder)

    def writers(self, positions: list[Positions]) -> dict[str, Write]:
        """Return functions that write the recording, and a picture of it at the largest yaw, by file name."""
        furthest = max(positions, key=lambda sample: abs(sample.head.yaw))

        def write_recording(path: Path) -> None:
            shutil.copyfile(self._path, path)

        def write_picture(path: Path) -> None:
            from beatrix_zenoh.recording.rrd.picture import pictures

            try:
                (png,) = pictures(self._path, [(SIDE_BY_SIDE, furthest.t_wall_ns / 1e9)])
            except (BeatrixError, ConnectionError) as error:
                raise Unavailable(str(error)) from error
            path.write_bytes(png)

        return {RECORDING: write_recording, "twins.png": write_picture}


def begin_recording(supervisor: Supervisor, settings: Settings) -> DemoRecording | None:
    """Start recording; if Rerun is not installed, print a note and return None."""
    try:
        return DemoRecording(supervisor, settings)
    except Refused as error:
        note(f"The demo continues without a recording. {error.message}")
        return None


def show_recording(path: Path) -> None:
    """Open the recording in a viewer that keeps running after the demo, if there is a display."""
    if not (
        sys.platform in ("win32", "darwin") or os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        return
    note(f"Opening {path} in the Rerun viewer.")
    subprocess.Popen(
        [sys.executable, "-m", "beatrix_zenoh.cli", "view", str(path)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
