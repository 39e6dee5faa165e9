"""The checks of `beatrix doctor` on this computer."""

from __future__ import annotations

import contextlib
import ctypes.util
import importlib.util
import os
import platform
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

from beatrix_zenoh import hiding

DISTRIBUTION = "beatrix-zenoh"
REQUIREMENT = re.compile(r"([A-Za-z0-9._-]+)")
ON_LINUX = re.compile(r"sys_platform\s*(==|!=)\s*['\"]linux['\"]\s*\)?\s*and")
"""Part of the marker of a requirement for Linux only, or for all other systems only."""
EXTRA = re.compile(r"extra\s*==\s*['\"]([a-z]+)['\"]")
VIDEO_DEVICES = Path("/dev/v4l/by-path")
SERIAL_DEVICES = ("ttyACM*", "ttyUSB*", "cu.usbmodem*", "cu.usbserial*")


PROBE = "from sim_node.gl import backend; print(backend() or '')"
PROBE_S = 45.0
"""Time limit of the probe (s), which tries two drivers for at most 20 s each."""


class Finding(NamedTuple):
    """A result of one check. The user must do `todo` and may follow `advice`; both may be empty."""

    what: str
    found: str
    todo: str = ""
    advice: str = ""

    @property
    def state(self) -> str:
        """One of ok, advice and todo."""
        return "todo" if self.todo else "advice" if self.advice else "ok"

    def as_row(self) -> dict[str, str]:
        """Return the fields of the finding, for JSON output."""
        return {**self._asdict(), "state": self.state}


def this_computer() -> Iterator[Finding]:
    """Yield the findings of all checks that need no network, except `graphics_probe`."""
    yield Finding("Python", f"{platform.python_version()} on {platform.system()} {platform.machine()}")
    yield from packages()
    yield from hidden_modules()
    yield from serial_ports()
    yield from cameras()


def packages() -> Iterator[Finding]:
    """Yield findings about this package and the packages that each extra needs."""
    if version(DISTRIBUTION) is None:
        yield Finding(
            DISTRIBUTION,
            "runs from its sources, not installed",
            "pip install -e . in the folder of the sources",
        )
        return
    yield Finding(DISTRIBUTION, metadata.version(DISTRIBUTION))
    needs: dict[str, list[str]] = {}
    for line in requirements():
        needed, only_for = REQUIREMENT.match(line), EXTRA.search(line)
        only_on = ON_LINUX.search(line)
        if only_on and (only_on[1] == "==") != (sys.platform == "linux"):
            continue
        if needed and needed[1] != DISTRIBUTION:
            needs.setdefault(only_for[1] if only_for else "", []).append(needed[1])
    needs.pop("all", None)
    for extra, names in needs.items():
        found = {name: version(name) for name in names}
        missing = [name for name, number in found.items() if number is None]
        title = f"extra {extra}" if extra else "core"
        present = ", ".join(f"{name} {number}" for name, number in found.items() if number)
        if missing:
            wanted = f".[{extra}]" if extra else "."
            yield Finding(
                title,
                f"without {', '.join(missing)}",
                advice=f'if you need it: pip install "{wanted}" in the folder of BEATRIX',
            )
        else:
            yield Finding(title, present)


def requirements() -> list[str]:
    """Return the requirements of this package and of its extras; none if it is not installed."""
    try:
        return metadata.requires(DISTRIBUTION) or []
    except metadata.PackageNotFoundError:
        return []


def distribution(requirement: str) -> str:
    """Return the name of the distribution in a requirement, in the form in which names are compared."""
    name = REQUIREMENT.match(requirement)
    return re.sub("[-_.]+", "-", name[1]).lower() if name else ""


def version(name: str) -> str | None:
    """Return the version of a distribution; None if it is not installed."""
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def hidden_modules() -> Iterator[Finding]:
    """Yield a finding about each file, in this folder or in PYTHONPATH, that hides a module that BEATRIX needs."""
    first, later = hiding.search_path()
    needed = {distribution(line) for line in requirements()}
    packages = {
        package
        for package, owners in metadata.packages_distributions().items()
        if needed.intersection(map(distribution, owners))
    }
    found = hiding.hidden({*hiding.loaded(), *packages, *hiding.OURS}, ["", *first], later)
    for name, file in sorted(found.items()):
        yield Finding(f"module {name}", *hiding.texts(name, file))
    if not found:
        yield Finding("hidden modules", "none")


@contextlib.contextmanager
def graphics_probe() -> Iterator[Callable[[], Finding]]:
    """Start a subprocess that draws with OpenGL, if MuJoCo is installed; yield a function that returns the finding.

    A broken driver would hang or crash this process, hence a subprocess. The other checks run during the half second
    that the import of MuJoCo takes.
    """
    if importlib.util.find_spec("mujoco") is None:
        yield lambda: Finding(
            "graphics", "not checked: only simulations draw, and the extra sim is not installed"
        )
        return
    command = [sys.executable, "-c", PROBE]
    with subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as child:
        try:
            yield lambda: graphics(child)
        finally:
            child.kill()


def graphics(child: subprocess.Popen[str]) -> Finding:
    """Return a finding about OpenGL, which draws the pictures of simulated eyes, from the output of PROBE."""
    try:
        name = child.communicate(timeout=PROBE_S)[0].strip()
    except subprocess.TimeoutExpired:
        name = ""
    if child.returncode not in (0, None):
        return Finding(
            "graphics", "not checked: the package sim_node does not start", advice='pip install ".[sim]"'
        )
    if name:
        return Finding("graphics", f"OpenGL works ({name})")
    missing = sys.platform == "linux" and not any(map(ctypes.util.find_library, ("EGL", "OSMesa")))
    return Finding(
        "graphics",
        "OpenGL does not work: simulations draw the pictures of the eyes by ray casting, at a lower resolution",
        advice="for full resolution: apt install libegl1 libgl1-mesa-dri"
        if missing
        else "for full resolution: update the graphics driver, and unset MUJOCO_GL if it is set",
    )


def serial_ports() -> Iterator[Finding]:
    """Yield findings about serial devices, and whether this user may open them."""
    if os.name == "nt":
        return  # on Windows every user may open ports, and their names do not show which one is a board
    devices = sorted(device for pattern in SERIAL_DEVICES for device in Path("/dev").glob(pattern))
    if not devices:
        yield Finding("serial ports", "no board on USB; `beatrix hw --port virtual:` needs none")
    for device in devices:
        if os.access(device, os.R_OK | os.W_OK):
            yield Finding(f"port {device}", "this user may open it")
        else:
            yield Finding(
                f"port {device}",
                "this user may not open it",
                "sudo usermod -aG dialout $USER, then log out and in again",
            )


def cameras() -> Iterator[Finding]:
    """Yield findings about USB cameras by their permanent paths, and whether this user may open them."""
    for device in sorted(VIDEO_DEVICES.glob("*-video-index0")):
        if os.access(device, os.R_OK | os.W_OK):
            yield Finding("camera", f"{device}: this user may open it")
        else:
            yield Finding(
                "camera",
                f"{device}: this user may not open it",
                "sudo usermod -aG video $USER, then log out and in again",
            )
