"""`beatrix view`: show the live robots, or a recording, in the Rerun viewer."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated
from urllib.parse import quote

import typer

from beatrix_zenoh.client.session import Client
from beatrix_zenoh.contract import names
from beatrix_zenoh.output import FAILED, note, say
from beatrix_zenoh.recording.verbs.files import describe, note_if_incomplete
from beatrix_zenoh.recording.viewer import PORT, WEB_PORT, check_recording
from beatrix_zenoh.settings import Settings, resolve
from beatrix_zenoh.shutdown import POLL_S, Shutdown
from beatrix_zenoh.terminal.options import Cameras, Connect, Names, ViewerPort, Who

if TYPE_CHECKING:  # importing numpy and rerun would delay every verb
    from beatrix_zenoh.recording.recorder import Recorder
    from beatrix_zenoh.recording.viewer import Viewer


def view(
    file: Annotated[
        Path | None, typer.Argument(metavar="FILE.rrd", help="A recording; default: the live robots.")
    ] = None,
    name: Names = None,
    cameras: Cameras = 10.0,
    web: Annotated[
        bool,
        typer.Option(
            "--web", help="Show the viewer in a browser on this computer; other computers cannot connect."
        ),
    ] = False,
    port: ViewerPort = PORT,
    web_port: Annotated[int, typer.Option(min=1, max=65535, help="Port of the web page.")] = WEB_PORT,
    connect: Connect = None,
    who: Who = None,
) -> None:
    """Show the live robots, or a recording, in the Rerun viewer.

    Ends when the viewer's window is closed, or with Ctrl-C.
    """
    if file is not None:
        check_recording(file)
    for robot in name or []:
        names.check_name(robot)
    shutdown = Shutdown()
    shutdown.handle_signals()
    page = web_port if web else None
    if file is not None:
        viewer = open_viewer(port, str(file), web_port=page)
        try:
            announce(port, page, str(file))
            describe(file)
            note_if_incomplete(file)
            wait_for(viewer, shutdown)
        finally:
            if viewer is not None:
                viewer.end()
    else:
        show_live(resolve(None, connect, who), shutdown, name or [], cameras, port, page)


def announce(port: int, web_port: int | None, what: str) -> None:
    """Print `ready`, and the address of the web page if there is one."""
    if web_port is None:
        say(f"ready {what}")
        return
    data = quote(f"rerun+http://127.0.0.1:{port}/proxy", safe="")
    say(f"ready http://127.0.0.1:{web_port}?url={data}")
    note("Open this address in a browser on this computer.")


def open_viewer(port: int, *words: str, web_port: int | None = None) -> Viewer | None:
    """Start a viewer and return it; return None if a window is open already and there is no file to show.

    Args:
        port: port on which the viewer accepts data.
        words: files to show.
        web_port: port of the web page; None: show a window instead.

    Raises:
        Refused: BAD_VALUE, Rerun is not installed, the port is taken, or no window can be opened here.
        NoAnswer: TIMED_OUT, the viewer did not start in time.
    """
    from beatrix_zenoh.processes import free_port
    from beatrix_zenoh.recording.viewer import Viewer, answers

    if web_port is None and answers(port):
        if not words:
            note(f"Using the viewer that is open on port {port}.")
            return None
        port = free_port()
    if web_port is None:
        viewer = Viewer(port, *words)
    else:
        viewer = Viewer(port, *words, "--serve-web", "--web-viewer-port", str(web_port))
    try:
        viewer.wait_ready()
        if web_port is not None:
            viewer.wait_ready(web_port)
    except BaseException:
        viewer.end()
        raise
    return viewer


def show_live(
    settings: Settings, shutdown: Shutdown, robots: list[str], cameras: float, port: int, web_port: int | None
) -> None:
    """Show live robots in a viewer until it is closed or a shutdown is requested; for the arguments see `view`."""
    with Client(settings, announce=False) as client:
        viewer = open_viewer(port, web_port=web_port)
        from beatrix_zenoh.recording.outputs import LiveOutput
        from beatrix_zenoh.recording.recorder import RecordingOptions, start_recording

        options = RecordingOptions(robots, cameras)
        recorder = start_recording(client, [LiveOutput(port, note)], note, options)
        try:
            announce(port, web_port, "live robots")
            wait_for(viewer, shutdown, recorder)
        finally:
            if viewer is not None:
                viewer.end()  # first, because the recorder would wait for a viewer that does not read
            closed = recorder.close()
    leave(0, closed=closed)


def leave(code: int, *, closed: bool) -> None:
    """End the verb with this exit code; unless `closed`, end the process at once: Rerun would wait for the viewer."""
    if not closed:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
    if code:
        raise typer.Exit(code)


def wait_for(viewer: Viewer | None, shutdown: Shutdown, recorder: Recorder | None = None) -> None:
    """Wait until the window is closed or a shutdown is requested; raises typer.Exit if the viewer has failed."""
    while not shutdown.requested(POLL_S):
        if recorder is not None:
            recorder.check()
        if viewer is not None and viewer.code is not None:
            if viewer.code:
                note(viewer.ending())
                raise typer.Exit(FAILED)
            return
