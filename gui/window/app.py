"""`beatrix gui`: the window that drives and shows both robots of one name."""

from __future__ import annotations

import ctypes
import os
import socket
import sys
from pathlib import Path
from typing import Annotated

import typer

from beatrix_zenoh import threads
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.settings import resolve
from beatrix_zenoh.terminal.options import Connect, Name, Who
from beatrix_zenoh.terminal.run import missing, run_command
from gui.console.state.intents import Theme
from gui.console.texts import LANGUAGES

PLUGINS = "QT_QPA_PLATFORM_PLUGIN_PATH"
WITHOUT_DISPLAY = {"offscreen", "minimal", "vnc"}
"""Platforms of Qt that need no display."""
CONNECT_S = 10.0
"""Time limit for a display on another computer to answer."""


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
    """Remove the plugin path of opencv-python from the environment; raise Refused if no window can be opened.

    Without this check Qt would end the process with a core dump. The check takes milliseconds, because it connects to
    the display as Qt does, without starting Qt.
    """
    if "cv2" in os.environ.get(PLUGINS, ""):  # set by opencv-python, whose plugins do not fit PyQt's Qt
        del os.environ[PLUGINS]
    platform = os.environ.get("QT_QPA_PLATFORM", "").partition(":")[0]
    if platform in WITHOUT_DISPLAY or not sys.platform.startswith("linux"):
        return
    wayland = platform.startswith("wayland")
    if not (_answers_wayland() if wayland else _answers_x11()):
        raise Refused(
            Reason.BAD_VALUE,
            "No window can be opened because there is no display. Start `beatrix gui` on a computer with a screen; "
            "most other verbs of `beatrix` need no display.",
        )
    _load_plugin("libqwayland-generic.so" if wayland else "libqxcb.so")


def _answers_x11() -> bool:
    """Return whether the X server of DISPLAY accepts this user, by the library that Qt's plugin uses."""
    try:
        xcb = ctypes.CDLL("libxcb.so.1")
    except OSError:
        return True  # `_load_plugin` names the missing library
    xcb.xcb_connect.restype = ctypes.c_void_p
    xcb.xcb_connection_has_error.argtypes = (ctypes.c_void_p,)
    errors: list[int] = []

    def connect() -> None:
        connection = xcb.xcb_connect(None, None)  # waits without limit for an address that does not answer
        errors.append(xcb.xcb_connection_has_error(connection))
        # It stays open: a server without other clients would reset itself, and refuse Qt's connection meanwhile.

    threads.start(connect, "window-display").join(CONNECT_S)
    return errors == [0]


def _answers_wayland() -> bool:
    """Return whether a Wayland compositor listens at the socket of WAYLAND_DISPLAY."""
    folder, name = os.environ.get("XDG_RUNTIME_DIR", ""), os.environ.get("WAYLAND_DISPLAY") or "wayland-0"
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as compositor:
        compositor.settimeout(CONNECT_S)
        try:
            compositor.connect(str(Path(folder, name)))
        except OSError:
            return False
    return True


def _load_plugin(name: str) -> None:
    """Load Qt's plugin of the display; raise Refused with the missing library, for which Qt would abort."""
    from PyQt5.QtCore import QLibraryInfo  # noqa: PLC0415 - may not be installed

    folder = os.environ.get(PLUGINS) or QLibraryInfo.location(QLibraryInfo.PluginsPath) + "/platforms"
    plugin = Path(folder, name)
    if not plugin.exists():  # Qt has other plugins, and reports if none fits
        return
    try:
        ctypes.CDLL(str(plugin))
    except OSError as error:
        raise Refused(
            Reason.BAD_VALUE,
            f"No window can be opened because Qt cannot use the display: {error}. Install the missing library; on "
            "Debian and Ubuntu `sudo apt install libxcb-xinerama0 libxkbcommon-x11-0 libxcb-icccm4 libxcb-image0 "
            "libxcb-keysyms1 libxcb-render-util0` brings those of Qt.",
        ) from None


def main(words: list[str] | None = None) -> int:
    """Run `beatrix gui`, as an entry point of group `beatrix.processes`; return the exit code."""
    return run_command(gui, "beatrix gui", words)
