"""`beatrix gui`: the window that drives and shows both robots of one name."""

from __future__ import annotations

import os
import sys
from typing import Annotated

import typer

from beatrix_zenoh.contract.errors import bad_value
from beatrix_zenoh.settings import resolve
from beatrix_zenoh.terminal.options import Connect, Name, Who
from beatrix_zenoh.terminal.run import missing, run_command
from gui.console.state.intents import Theme
from gui.console.texts import LANGUAGES

PLUGINS = "QT_QPA_PLATFORM_PLUGIN_PATH"
WITHOUT_DISPLAY = {"offscreen", "minimal", "vnc", "linuxfb", "eglfs"}
"""Platforms of Qt that need no display."""
DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")
"""Variables of which a desktop sets one."""


def known(code: str | None) -> str | None:
    """Return the language code, or None if none was given; raises BadParameter if the window has no such language."""
    if code is None or code in LANGUAGES:
        return code
    raise typer.BadParameter(
        f"'{code}' is not a language of the window. Choose one of {', '.join(LANGUAGES)}."
    )


def gui(
    *,
    theme: Annotated[
        Theme | None, typer.Option(help="Colours and sizes; default: those chosen last.")
    ] = None,
    language: Annotated[
        str | None,
        typer.Option(
            metavar="CODE", callback=known, help="Language, en or de; default: the one chosen last."
        ),
    ] = None,
    name: Name = None,
    connect: Connect = None,
    who: Who = None,
) -> None:
    """Open the window that drives both robots. Close the window or press Ctrl-C to end the command."""
    settings = resolve(name, connect, who)
    try:
        from gui.window.run import run  # noqa: PLC0415 - Qt takes a third of a second to import, and may not be installed
    except ModuleNotFoundError as error:
        raise missing("gui", error) from error
    check_display()
    given = settings.named or bool(settings.account is not None and settings.account.robot)
    raise typer.Exit(run(settings, theme, language, name_given=given))


def check_display() -> None:
    """Remove the plugin path of opencv-python from the environment; raise Refused if there is no display.

    Qt would end this process with a core dump.
    """
    if "cv2" in os.environ.get(PLUGINS, ""):  # set by opencv-python, whose plugins do not fit PyQt's Qt
        del os.environ[PLUGINS]
    platform = os.environ.get("QT_QPA_PLATFORM", "").partition(":")[0]
    given = platform in WITHOUT_DISPLAY or any(os.environ.get(name) for name in DISPLAYS)
    if sys.platform.startswith("linux") and not given:
        raise bad_value(
            "No window can be opened because there is no display: neither DISPLAY nor WAYLAND_DISPLAY is set. Start "
            "`beatrix gui` on a computer with a screen; most other verbs of `beatrix` need no display.",
        )


def main(words: list[str] | None = None) -> int:
    """Run `beatrix gui`, as an entry point of group `beatrix.processes`; return the exit code."""
    return run_command(gui, "beatrix gui", words)
