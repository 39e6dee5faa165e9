"""Simulated USB cameras: named pipes that look like cameras to a program with tests/support/fake_camera.c preloaded."""

from __future__ import annotations

import fcntl
import os
import struct
import subprocess
from pathlib import Path

SOURCE = Path(__file__).with_suffix(".c")
HEAD = struct.Struct("=II")
PIPE = 1 << 20
"""Size of the pipe (bytes), for the pictures that are sent before the stream starts."""


def library(folder: Path) -> Path:
    """Build the library for LD_PRELOAD; return its path."""
    built = folder / "fake_camera.so"
    options = ["-std=c11", "-Wall", "-Wextra", "-Werror", "-O1", "-shared", "-fPIC"]
    subprocess.run(["gcc", *options, "-o", str(built), str(SOURCE), "-ldl"], check=True)
    return built


class FakeCamera:
    """One camera, plugged in from the start. Pictures that are sent while it does not stream are lost."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._pipe = -1
        self.plug()

    def plug(self) -> None:
        """Plug the camera in."""
        os.mkfifo(self.path)
        self._pipe = os.open(self.path, os.O_RDWR | os.O_NONBLOCK)
        fcntl.fcntl(self._pipe, fcntl.F_SETPIPE_SZ, PIPE)

    def unplug(self) -> None:
        """Pull the cable."""
        self.path.unlink()
        os.write(self._pipe, HEAD.pack(0, 0))
        os.close(self._pipe)

    def send(self, picture: bytes, *, damaged: bool = False) -> None:
        """Send a picture."""
        data = HEAD.pack(len(picture), damaged) + picture
        assert os.write(self._pipe, data) == len(data), "the pipe is full"

    def refuse(self, number: int, from_hz: int = 1) -> None:
        """Refuse streams at `from_hz` or above with this errno from now on; 0: accept all rates again."""
        path = self.path.with_name(f"{self.path.name}.refuses")
        path.write_text(f"{number} {from_hz}") if number else path.unlink()

    @property
    def asked(self) -> str:
        """Size, format, period and buffers of the stream; empty if the camera does not stream."""
        path = self.path.with_name(f"{self.path.name}.asked")
        try:
            return path.read_text()
        except FileNotFoundError:  # the other process may remove the file at any time
            return ""

    def close(self) -> None:
        """Free the pipe."""
        os.close(self._pipe)
