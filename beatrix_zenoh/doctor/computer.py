"""The checks of `beatrix doctor` on this computer: Python, packages, hidden modules, drawing, ports, cameras."""

from __future__ import annotations

import importlib.util
import os
import platform
import re
import subprocess
import sys
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from beatrix_zenoh import hiding
from beatrix_zenoh.doctor.checks import CheckResult
from beatrix_zenoh.requirements import DISTRIBUTION, bounds, distribution, misfits, requirements, suits

EXTRA = re.compile(r"extra\s*==\s*['\"]([a-z]+)['\"]")
VIDEO_DEVICES = Path("/dev/v4l/by-path")
SERIAL_DEVICES = ("ttyACM*", "ttyUSB*", "cu.usbmodem*", "cu.usbserial*")


PROBE = """
from beatrix_zenoh import hiding
try:
    from sim_node.gl import backend
except Exception as error:
    raise SystemExit(hiding.cause(error))
print(backend() or "")
"""
PROBE_S = 45.0
"""Time limit of the probe (s), which tries two drivers for at most 20 s each."""


def this_computer() -> Iterator[CheckResult]:
    """Yield the findings of all checks that need no network."""
    yield CheckResult("Python", f"{platform.python_version()} on {platform.system()} {platform.machine()}")
    yield from packages()
    yield from hidden_modules()
    yield from serial_ports()
    yield from cameras()
    yield graphics()


def packages() -> Iterator[CheckResult]:
    """Yield findings about this package and the packages that each extra needs."""
    if version(DISTRIBUTION) is None:
        yield CheckResult(
            DISTRIBUTION,
            "runs from its sources, not installed",
            "pip install -e . in the folder of the sources",
        )
        return
    yield CheckResult(DISTRIBUTION, metadata.version(DISTRIBUTION))
    needs: dict[str, dict[str, str]] = {}
    for line in requirements():
        only_for = EXTRA.search(line)
        if distribution(line) != DISTRIBUTION:
            needs.setdefault(only_for[1] if only_for else "", {})[distribution(line)] = line
    needs.pop("all", None)
    for extra, lines in needs.items():
        found = {name: version(name) for name in lines}
        missing = [name for name, number in found.items() if number is None]
        wrong = [
            bounds(lines[name]) for name, number in found.items() if number and not suits(number, lines[name])
        ]
        title = f"extra {extra}" if extra else "core"
        present = ", ".join(f"{name} {number}" for name, number in found.items() if number)
        install = f"beatrix install {extra}" if extra else f"pip install {DISTRIBUTION}"
        yield CheckResult(
            title,
            f"without {', '.join(missing)}" if missing else present,
            f"it needs {', '.join(wrong)}: {install}" if wrong else "",
            f"if you need it: {install}" if missing else "",
        )


def version(name: str) -> str | None:
    """Return the version of a distribution; None if it is not installed. `hidden_modules` judges those in PYTHONPATH."""
    first, later = hiding.search_path()
    return next((one.version for one in metadata.distributions(name=name, path=[*later, *first])), None)


def hidden_modules() -> Iterator[CheckResult]:
    """Yield a finding about each file or package, in this folder or in PYTHONPATH, that BEATRIX cannot use."""
    first, later = hiding.search_path()
    needed = {distribution(line) for line in requirements()}
    packages = {
        package
        for package, owners in metadata.packages_distributions().items()
        if needed.intersection(map(distribution, owners))
    }
    first = ["", *first]
    found = hiding.hidden({*hiding.loaded(), *packages, *hiding.OURS}, first, later)
    for name, file in sorted(found.items()):
        yield CheckResult(f"module {name}", *hiding.texts(name, file))
    unfit = misfits(first)
    for name, texts in unfit.items():
        yield CheckResult(f"package {name}", *texts)
    if not found and not unfit:
        yield CheckResult("hidden modules", "none")


def graphics() -> CheckResult:
    """Return a finding about OpenGL, which draws the pictures of simulated eyes.

    A broken driver would hang or crash this process, so a subprocess draws.
    """
    if importlib.util.find_spec("mujoco") is None:
        return CheckResult(
            "graphics", "not checked: only simulations draw, and the extra sim is not installed"
        )
    command = [sys.executable, "-P", "-c", PROBE]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=PROBE_S, check=False)
    except subprocess.TimeoutExpired:
        done = subprocess.CompletedProcess(command, 0, "", "")
    if done.returncode:
        return CheckResult(
            "graphics",
            "not checked: the package sim_node does not start",
            advice=done.stderr.strip().rpartition("\n")[2] or "beatrix install sim",
        )
    if name := done.stdout.strip():
        return CheckResult("graphics", f"OpenGL works ({name})")
    return CheckResult(
        "graphics",
        "OpenGL does not work: the eyes of simulations see nothing",
        advice="on Linux apt install libegl1 libgl1-mesa-dri libopengl0, or update the graphics driver; unset MUJOCO_GL if it is set",
    )


def serial_ports() -> Iterator[CheckResult]:
    """Yield findings about serial devices, and whether this user may open them."""
    if os.name == "nt":
        return  # on Windows every user may open ports, and their names do not show which one is a board
    devices = sorted(device for pattern in SERIAL_DEVICES for device in Path("/dev").glob(pattern))
    if not devices:
        yield CheckResult("serial ports", "no board on USB; `beatrix hw --port virtual:` needs none")
    for device in devices:
        yield may_open(f"port {device}", device, "dialout")


def may_open(title: str, device: Path, group: str, shown: str = "") -> CheckResult:
    """Return a finding, which begins with `shown`, about a device that the users of a group may open."""
    if os.access(device, os.R_OK | os.W_OK):
        return CheckResult(title, f"{shown}this user may open it")
    advice = f"sudo usermod -aG {group} $USER, then log out and in again"
    return CheckResult(title, f"{shown}this user may not open it", advice)


def cameras() -> Iterator[CheckResult]:
    """Yield findings about USB cameras by their permanent paths, and whether this user may open them."""
    for device in sorted(VIDEO_DEVICES.glob("*-video-index0")):
        yield may_open("camera", device, "video", f"{device}: ")
