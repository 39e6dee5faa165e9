"""The checks of `beatrix doctor`: on this computer, and from the router to each robot."""

from __future__ import annotations

import contextlib
import ctypes.util
import importlib.util
import os
import platform
import re
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from importlib import metadata
from importlib.machinery import PathFinder
from pathlib import Path
from typing import NamedTuple

from beatrix_zenoh import hiding
from beatrix_zenoh.client.monitor import Monitor
from beatrix_zenoh.client.plan import unlike
from beatrix_zenoh.client.robot import Robot
from beatrix_zenoh.client.robot_base import clock_offsets
from beatrix_zenoh.client.session import Client, Place
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import CONTRACT, Fault, Info, Reason, Status
from beatrix_zenoh.contract.errors import BeatrixError, NoAnswer
from beatrix_zenoh.requirements import DISTRIBUTION, bounds, distribution, misfits, requirements, suits
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.terminal.states import ListedRobot, listed, problems, state

ON_LINUX = re.compile(r"sys_platform\s*(==|!=)\s*['\"]linux['\"]\s*\)?\s*and")
"""Part of the marker of a requirement for Linux only, or for all other systems only."""
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


class CheckResult(NamedTuple):
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


def this_computer() -> Iterator[CheckResult]:
    """Yield the findings of all checks that need no network, except `graphics_probe`."""
    yield CheckResult("Python", f"{platform.python_version()} on {platform.system()} {platform.machine()}")
    yield from packages()
    yield from hidden_modules()
    yield from serial_ports()
    yield from cameras()


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
        only_for, only_on = EXTRA.search(line), ON_LINUX.search(line)
        if only_on and (only_on[1] == "==") != (sys.platform == "linux"):
            continue
        if distribution(line) != DISTRIBUTION:
            needs.setdefault(only_for[1] if only_for else "", {})[distribution(line)] = line
    needs.pop("all", None)
    for extra, lines in needs.items():
        found = {name: version(name) for name in lines}
        missing = [name for name, number in found.items() if number is None]
        title = f"extra {extra}" if extra else "core"
        present = ", ".join(f"{name} {number}" for name, number in found.items() if number)
        wrong = [
            bounds(lines[name]) for name, number in found.items() if number and not suits(number, lines[name])
        ]
        install = f'pip install "{f".[{extra}]" if extra else "."}" in the folder of BEATRIX'
        if missing:
            yield CheckResult(title, f"without {', '.join(missing)}", advice=f"if you need it: {install}")
        elif wrong:
            yield CheckResult(title, present, f"it needs {', '.join(wrong)}: {install}")
        else:
            yield CheckResult(title, present)


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
    broken = {name: why for name in sorted(packages) if (why := broken_copy(name, first))}
    first = ["", *first]
    found = hiding.hidden({*hiding.loaded(), *packages, *hiding.OURS}, first, later)
    for name, file in sorted(found.items()):
        yield CheckResult(f"module {name}", *hiding.texts(name, file))
    unfit = misfits(first)
    for name, texts in unfit.items():
        yield CheckResult(f"package {name}", *texts)
    for name in broken.keys() - found.keys() - unfit.keys():
        yield CheckResult(f"package {name}", "cannot be imported", broken[name])
    if not found and not unfit and not broken:
        yield CheckResult("hidden modules", "none")


def broken_copy(name: str, first: list[str]) -> str:
    """Return why the package of this name in one of the folders cannot be imported; empty: it can, or none has it."""
    if PathFinder.find_spec(name, first) is None:
        return ""
    try:
        importlib.import_module(name)
    except Exception as error:  # noqa: BLE001 - a package for another Python may raise anything
        return hiding.cause(error)
    return ""


@contextlib.contextmanager
def graphics_probe() -> Iterator[Callable[[], CheckResult]]:
    """Start a subprocess that draws with OpenGL, if MuJoCo is installed; yield a function that returns the finding.

    A broken driver would hang or crash this process, hence a subprocess. The other checks run during the half second
    that the import of MuJoCo takes.
    """
    if importlib.util.find_spec("mujoco") is None:
        yield lambda: CheckResult(
            "graphics", "not checked: only simulations draw, and the extra sim is not installed"
        )
        return
    command = [sys.executable, "-P", "-c", PROBE]
    with subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as child:
        try:
            yield lambda: graphics(child)
        finally:
            child.kill()


def graphics(child: subprocess.Popen[str]) -> CheckResult:
    """Return a finding about OpenGL, which draws the pictures of simulated eyes, from the output of PROBE."""
    try:
        name, why = (text.strip() for text in child.communicate(timeout=PROBE_S))
    except subprocess.TimeoutExpired:
        name, why = "", ""
    if child.returncode not in (0, None):
        return CheckResult(
            "graphics",
            "not checked: the package sim_node does not start",
            advice=why.rpartition("\n")[2] or 'pip install ".[sim]" in the folder of BEATRIX',
        )
    if name:
        return CheckResult("graphics", f"OpenGL works ({name})")
    missing = sys.platform == "linux" and not any(map(ctypes.util.find_library, ("EGL", "OSMesa")))
    return CheckResult(
        "graphics",
        "OpenGL does not work: simulations draw the pictures of the eyes by ray casting, at a lower resolution",
        advice="for full resolution: apt install libegl1 libgl1-mesa-dri"
        if missing
        else "for full resolution: update the graphics driver, and unset MUJOCO_GL if it is set",
    )


def serial_ports() -> Iterator[CheckResult]:
    """Yield findings about serial devices, and whether this user may open them."""
    if os.name == "nt":
        return  # on Windows every user may open ports, and their names do not show which one is a board
    devices = sorted(device for pattern in SERIAL_DEVICES for device in Path("/dev").glob(pattern))
    if not devices:
        yield CheckResult("serial ports", "no board on USB; `beatrix hw --port virtual:` needs none")
    for device in devices:
        if os.access(device, os.R_OK | os.W_OK):
            yield CheckResult(f"port {device}", "this user may open it")
        else:
            yield CheckResult(
                f"port {device}",
                "this user may not open it",
                "sudo usermod -aG dialout $USER, then log out and in again",
            )


def cameras() -> Iterator[CheckResult]:
    """Yield findings about USB cameras by their permanent paths, and whether this user may open them."""
    for device in sorted(VIDEO_DEVICES.glob("*-video-index0")):
        if os.access(device, os.R_OK | os.W_OK):
            yield CheckResult("camera", f"{device}: this user may open it")
        else:
            yield CheckResult(
                "camera",
                f"{device}: this user may not open it",
                "sudo usermod -aG video $USER, then log out and in again",
            )


OFFSET_S = 0.05
"""Largest clock offset without advice (s); with a larger offset the times of two robots are hard to compare."""
RATE_S = 0.6
"""Time over which the rate of positions is measured (s)."""
SLOW = 0.9
"""Fraction of the contract's rate of positions; a lower rate is reported."""


def network(settings: Settings, name: str | None = None) -> Iterator[CheckResult]:
    """Yield findings about router, account and robots; stop after the first step that fails.

    If no robot of the name `name` is online, one of the findings says so.
    """
    try:
        client = Client(settings)
    except NoAnswer as error:
        if error.reason is Reason.ACCOUNT_REFUSED:
            yield CheckResult("router", "accepts connections")
            yield CheckResult("account", "not accepted", error.message)
        else:
            yield CheckResult("router", "does not answer", error.message)
        return
    with client:
        yield CheckResult("router", "answers")
        try:
            account = accepted(client)
            yield account
            if not account.todo:
                yield from robots(client, name)
        except NoAnswer as error:
            yield CheckResult("router", "was lost during the checks", error.message)


def accepted(client: Client) -> CheckResult:
    """Return a finding about the account with which the router has accepted this session."""
    account = client.settings.account
    if account is None:
        return CheckResult("account", "none: this router is open to every program")
    refused = client.bus.refusal(client.token)
    if refused is not None:
        return CheckResult("account", "has no rights", refused.message)
    found = f"{account.name} of class {account.class_name}, accepted, valid until {account.expires}"
    return CheckResult("account", found)


def robots(client: Client, name: str | None) -> Iterator[CheckResult]:
    """Yield findings about every robot online, and about the robot `name` if it is not online."""
    with Monitor(client) as monitor:
        began_s = time.monotonic()
        found = listed(client, monitor)
        if name is not None and all(robot.place[0] != name for robot in found):
            yield missing(name, [str(robot) for robot in found])
        elif not found:
            yield CheckResult("robots", "none online", advice="to start one: beatrix sim, or beatrix up")
        if not found:
            return
        time.sleep(max(0.0, began_s + RATE_S - time.monotonic()))
        rates = {robot.place: monitor.robot(*robot.place).hz for robot in found}
    nodes = Counter(client.bus.claims())
    for robot in found:
        yield from one_robot(client, robot, rates[robot.place], nodes[robot.place])
    yield from unlike_sides({robot.place: robot.info for robot in found if robot.info is not None})


def missing(name: str, others: list[str]) -> CheckResult:
    """Return the finding about a robot that is not online; `others` are online."""
    found = f"not online; online: {', '.join(others) or 'no robot'}"
    return CheckResult(name, found, "look at the output of its node, or start it: beatrix sim or beatrix hw")


def one_robot(client: Client, listed_robot: ListedRobot, hz: float, nodes: int) -> Iterator[CheckResult]:
    """Yield findings about a robot; `hz` is its rate of positions, `nodes` the number of nodes that serve it."""
    name, robot = str(listed_robot), Robot(*listed_robot.place, client=client)
    try:
        status = robot.status()
    except BeatrixError as error:
        yield CheckResult(name, "online, but does not answer", error.message)
        return
    if nodes > 1:
        yield CheckResult(name, f"{nodes} nodes serve it, and all execute its commands", "end all but one")
    text, well = " ".join(problems(status)), status.fault is Fault.NONE
    yield CheckResult(
        name, f"answers, {state(status)}", todo="" if well else text, advice=text if well else ""
    )
    yield rate(name, hz)
    yield clock(robot)
    if listed_robot.info is not None:
        yield contract(name, listed_robot.info)
    yield from devices(name, status)


def rate(name: str, hz: float) -> CheckResult:
    """Return a finding about the rate of positions (Hz)."""
    text = f"{hz:.0f} positions a second of {keys.POSITIONS_HZ}"
    if hz < SLOW * keys.POSITIONS_HZ:
        return CheckResult(
            name,
            text,
            advice="end other programs on its computer and on this one, or use a cable instead of Wi-Fi",
        )
    return CheckResult(name, text)


def contract(title: str, info: Info) -> CheckResult:
    """Return a finding about whether the robot has the same messages and keys as this computer."""
    if info.contract == CONTRACT:
        return CheckResult(
            title, f"version {info.version}, same messages ({CONTRACT}), firmware {info.firmware or 'none'}"
        )
    return CheckResult(
        title,
        f"version {info.version} has contract {info.contract}, this computer has {CONTRACT}",
        "install the same version of beatrix-zenoh on both",
    )


def devices(name: str, status: Status) -> Iterator[CheckResult]:
    """Yield findings about a connected board and the cameras; `one_robot` reports why no board is connected."""
    board = status.board
    if board.connected:
        yield CheckResult(name, f"board {board.name or 'without a name'} at {board.port}")
    for camera in status.cameras:
        text = f"camera {camera.eye}: {camera.source or 'runs only while a client subscribes'}"
        if camera.connected and not camera.trouble:
            yield CheckResult(name, text)
        else:
            yield CheckResult(name, f"{text}, no pictures", camera.trouble or "plug the camera in")
    ears = status.microphones
    if ears is not None:
        text = f"microphones: {ears.source}, {'on: a client listens' if ears.streaming else 'off'}"
        yield CheckResult(name, text, ears.trouble)


def unlike_sides(infos: Mapping[Place, Info]) -> Iterator[CheckResult]:
    """Yield findings about simulations whose robot values differ from those of the hardware of the same name."""
    for (name, side), info in infos.items():
        hardware = infos.get((name, "hw"))
        if side == "sim" and hardware is not None and unlike(info, hardware):
            yield CheckResult(
                f"{name} (sim, hw)",
                "simulation and hardware run with different values",
                "start both with the same --robot-file, or without one",
            )


def clock(robot: Robot) -> CheckResult:
    """Return a finding about the offset of the robot's wall clock from that of this computer."""
    try:
        offset, bound = clock_offsets(robot.client, robot.name, robot.side).wall
    except BeatrixError as error:
        return CheckResult(str(robot), "clock offset unknown", error.message)
    ahead = "ahead" if offset > 0 else "behind"
    text = f"its clock is {abs(offset) * 1e3:.2f} ms {ahead} (+- {bound * 1e3:.2f} ms)"
    if abs(offset) > OFFSET_S + bound:
        return CheckResult(str(robot), text, advice="to compare times, set both clocks (NTP)")
    return CheckResult(str(robot), text)
