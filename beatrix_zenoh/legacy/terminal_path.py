"""The path of the pseudo-terminal for programs of 2023: claim it, link it, and let other users open the terminal."""

from __future__ import annotations

import contextlib
import hashlib
import os
import socket
import sys
from pathlib import Path
from typing import Final

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused

try:
    import grp
except ImportError:  # Windows, which has no pseudo-terminals either
    grp = None  # type: ignore[assignment]

LINK_PREFIX: Final = "/dev/.."
"""Prefix of the targets of our links, by which they are recognised: no other program writes targets in this way."""
GROUP: Final = "dialout"
"""On Linux the group of users who may open serial ports."""
GROUP_MODE: Final = 0o660


def claim(path: Path) -> socket.socket:
    """Reserve `path` for this node until the returned socket is closed or the process ends; only on Linux.

    Raises:
        Refused: BAD_VALUE: another node has reserved it.
    """
    held = socket.socket(socket.AF_UNIX)
    where = str(path.parent.resolve() / path.name)
    try:
        if sys.platform == "linux":  # only Linux has socket names that disappear with their process
            held.bind(b"\0beatrix-legacy-" + hashlib.sha256(os.fsencode(where)).hexdigest().encode())
    except OSError as error:
        held.close()
        raise Refused(
            Reason.BAD_VALUE,
            f"--legacy {path} is used by another node. Choose another path for this robot.",
        ) from error
    return held


def link(path: Path, device: str) -> None:
    """Link the claimed `path` to `device`; replace a link that an earlier node has left behind.

    Raises:
        Refused: BAD_VALUE: another file has this path, or this user may not write there.
    """
    try:
        if sys.platform == "linux" and path.is_symlink() and str(path.readlink()).startswith(LINK_PREFIX):
            path.unlink()
        path.symlink_to(LINK_PREFIX + device)
    except FileExistsError as error:
        raise Refused(
            Reason.BAD_VALUE,
            f"--legacy {path} already exists. Choose another path, or remove it if no program uses it.",
        ) from error
    except OSError as error:
        raise Refused(
            Reason.BAD_VALUE,
            f"--legacy {path}: {error.strerror}. Choose a path you may write, for example /tmp/beatrix; a link such as "
            "/dev/ttyACM9, which programs find by themselves, needs an administrator.",
        ) from error


def unlink(path: Path, device: str) -> None:
    """Remove `path` if it still leads to `device`."""
    with contextlib.suppress(OSError):
        if str(path.readlink()) == LINK_PREFIX + device:
            path.unlink()


def share(device: str) -> None:
    """Let the users who may open serial ports open `device`, if this process has the right to allow it."""
    if grp is None:
        return
    with contextlib.suppress(KeyError, OSError):  # no such group, or this user is not in it
        os.chown(device, -1, grp.getgrnam(GROUP).gr_gid)
        Path(device).chmod(GROUP_MODE)  # after chown, so that no other group can open it
