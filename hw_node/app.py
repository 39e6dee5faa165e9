"""`beatrix hw`: serve a robot's board."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from beatrix_zenoh.contract.errors import wrong_usage
from beatrix_zenoh.motion import robot_file as values
from beatrix_zenoh.node.serve import serve
from beatrix_zenoh.output import note, say
from beatrix_zenoh.settings import resolve
from beatrix_zenoh.terminal.options import Connect, Legacy, LogFile, OwnName, RobotFile
from beatrix_zenoh.terminal.run import run_command
from hw_node.body import MakeSensor, build
from hw_node.cameras.camera import TEST_EYES, choices
from hw_node.microphones import choose, microphone_sensor
from hw_node.port import VIRTUAL, listed

MicrophonesOption = Annotated[
    str | None,
    typer.Option(
        metavar="SOURCE",
        help="The microphones: a part of the name of a sound device, or its number, `file:PATH` (a WAV file), `tone`, or `off`; on only while a program listens.",
    ),
]


PortOption = Annotated[
    str,
    typer.Option(metavar="PORT", help="Serial port of the board, or `virtual:`; default: the board on USB."),
]


def print_ports(asked: bool) -> None:  # noqa: FBT001 - Typer calls it so
    """Print the serial ports on USB and end the program, if that was asked for."""
    if asked:
        lines = listed()
        for line in lines:
            say(line)
        if not lines:
            note(
                f"No serial port is on USB. Plug the board in, or start a virtual robot: beatrix hw --port {VIRTUAL}"
            )
        raise typer.Exit


PortsOption = Annotated[
    bool, typer.Option("--ports", callback=print_ports, help="Print the serial ports on USB, and end.")
]


def hw(
    port: PortOption = "",
    ports: PortsOption = False,  # noqa: ARG001, FBT002 - its callback ends the program
    camera: Annotated[
        list[str] | None,
        typer.Option(
            metavar="EYE=SOURCE",
            help="Source of the left or right eye: a path under /dev/v4l/by-path (Linux), a camera's number (Windows, macOS), `pattern`, or `file:PATH`.",
        ),
    ] = None,
    microphones: MicrophonesOption = None,
    legacy: Legacy = None,
    robot_file: RobotFile = None,
    log_file: LogFile = None,
    name: OwnName = None,
    connect: Connect = None,
) -> None:
    """Serve a real robot, or a virtual board. Ends with Ctrl-C; reconnects board and cameras after they were unplugged.

    --camera selects the camera of each eye; the default is camera_left and camera_right in beatrix.toml. If neither
    names a camera, the eyes of a virtual board show a test picture. --microphones is `microphones` in beatrix.toml, by
    default off.
    """
    check_port(port, legacy)
    settings = resolve(name, connect)
    robot = values.load(robot_file)
    words = camera or settings.cameras
    sensors: list[MakeSensor] = [*TEST_EYES] if port == VIRTUAL and not words else []
    sensors += [choice.sensor for choice in choices(words)]
    ears = choose(settings.microphones if microphones is None else microphones)
    if ears is not None:
        sensors.append(lambda node: microphone_sensor(node, ears))
    raise typer.Exit(
        serve(
            lambda name: build(port, name, robot, sensors),
            [settings.robot],
            settings,
            robot=robot,
            legacy=legacy,
            log_file=log_file,
        )
    )


def check_port(port: str, legacy: Path | None) -> None:
    """Raise WrongUsage (BAD_VALUE) for a virtual board without its colon, or a port that is for old programs, too."""
    if port == VIRTUAL.rstrip(":"):
        raise wrong_usage(f"--port {port}: write `{VIRTUAL}` with a colon for a virtual board.")
    if port and legacy is not None and Path(port).resolve() == legacy.resolve():
        raise wrong_usage(
            f"--legacy {legacy} is the board's own port: choose a path that does not exist yet, for example /tmp/beatrix.",
        )


def main(words: list[str] | None = None) -> int:
    """Run `beatrix hw`, and return the exit code; an entry point of group `beatrix.processes`."""
    return run_command(hw, "beatrix hw", words)
