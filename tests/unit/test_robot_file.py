"""Robot files of a lab: allowed values and error messages."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hw_node.app
import sim_node.app
from beatrix_zenoh.contract._generated.messages import PoseQuery
from beatrix_zenoh.contract._generated.robot import ALLOWED, ROBOT, RobotData
from beatrix_zenoh.contract._generated.serial import Telemetry
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.motion import robot_file
from beatrix_zenoh.node.planner import Planner
from beatrix_zenoh.output import USAGE

HOME = Telemetry(0, 1, 3, 0, 0, (0, 0, 0), (0, 0, 0), 0, 0)
NEAR = math.radians(2.0)
FIELDS = [(table, field) for table, fields in ALLOWED.items() for field in fields]


def write(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "lab.toml"
    path.write_text(text)
    return path


def test_values_of_the_file_replace_the_default_ones(tmp_path: Path) -> None:
    robot = robot_file.load(write(tmp_path, "[geometry]\narm0_azimuth = 30\n[limits]\ntilt_max = 20.0\n"))
    assert (robot.geometry.arm0_azimuth, robot.limits.tilt_max) == (30.0, 20.0)
    assert (robot.drive, robot.head) == (ROBOT.drive, ROBOT.head)


def test_the_shipped_robot_may_be_written_into_a_file(tmp_path: Path) -> None:
    text = "".join(
        f"[{table}]\n" + "".join(f"{field} = {getattr(getattr(ROBOT, table), field)}\n" for field in fields)
        for table, fields in ALLOWED.items()
    )
    assert robot_file.load(write(tmp_path, text)) == ROBOT


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("[geometri]\na = 1\n", "'geometri' is not a table. The tables are: geometry, drive"),
        ("[geometry]\narm_angel = 1\n", r"\[geometry\] has no 'arm_angel'. Its fields are: arm_angle"),
        ("geometry = 3\n", "is not a table"),
        ("[geometry\n", "cannot be read"),
        ("[geometry]\narm_angle = 'wide'\n", r"Expected `float`, got `str` - at `\$.geometry.arm_angle`"),
        ("[limits]\nyaw_max = true\n", r"Expected `float`, got `bool` - at `\$.limits.yaw_max`"),
        ("[limits]\ntilt_max = -5\n", r"tilt_max = -5.0: 5 to 44 deg is allowed: .* the rods"),
        ("[limits]\ntilt_max = 95\n", r"tilt_max = 95.0: 5 to 44 deg is allowed"),
        ("[limits]\nyaw_max = 300\n", r"yaw_max = 300.0: 5 to 180 deg is allowed: the firmware"),
        (
            "[limits]\nspeed_max = 10\n",
            r"speed_default = 30.0, the default value: 1 to 10 deg/s is allowed",
        ),
        ("[geometry]\narm0_azimuth = 1000\n", r"arm0_azimuth = 1000.0: -360 to 360 deg is allowed"),
        ("[geometry]\narm0_azimuth = nan\n", r"arm0_azimuth = nan: -360 to 360 deg is allowed"),
        ("[geometry]\nhand = 3\n", r"\[geometry\] hand = 3: -1 or 1 .*is allowed"),
        ("[geometry]\nhand = 1.0\n", r"Expected `int`, got `float` - at `\$.geometry.hand`"),
        ("[geometry]\narm_angle = 20\n", r"tilt_max = 35.0, the default value: 5 to 19 deg is allowed"),
        ("[geometry]\nrod_twist = 50\n", r"arm_angle, rod_twist and mount_angle let the head tilt 5.0°"),
        ("[geometry]\nrod_twist = 45\n", r"\[geometry\] arm_angle, rod_twist and mount_angle: .*does not close"),
        ("[geometry]\narm_angle = 65\nrod_twist = 80\nmount_angle = 108\n[limits]\ntilt_max = 54\n", "54: with these .* can snap .* At most 46°"),
        ("a = " + "[" * 50_000, "cannot be read"),
        ("#" * (robot_file.LONGEST_FILE + 1), "is longer than"),
        ("[drive]\nmicrosteps = 16\n", "fixed in the firmware.*`make generate`, `make firmware`, `beatrix flash`"),
        ("[geometry]\narm_spacing = 100.0\n", r"\[geometry\] arm_spacing is fixed in the firmware"),
        ("[drive]\nsign = [-1, 1, 1]\n", "If a motor turns the wrong way, reverse its plug"),
        ("[pins]\nenable = 9\n", r"\[pins\] enable is fixed in the firmware"),
    ],
)  # fmt: skip
def test_wrong_tables_fields_and_values_are_refused_with_their_names(
    tmp_path: Path, text: str, why: str
) -> None:
    with pytest.raises(WrongUsage, match=why) as refusal:
        robot_file.load(write(tmp_path, text))
    assert "lab.toml" in refusal.value.message


@pytest.mark.parametrize("main", [hw_node.app.main, sim_node.app.main])
def test_a_node_does_not_start_with_an_invalid_robot_file(
    main: Callable[[list[str]], int], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["--robot-file", str(write(tmp_path, "[limits]\ntilt_max = 95\n"))]) == USAGE
    assert "lab.toml: [limits] tilt_max = 95.0: 5 to 44 deg" in capsys.readouterr().err


def near(shipped: float) -> st.SearchStrategy[float]:
    """Strategy for numbers, most of them close to the default value."""
    close = st.floats(0.5, 1.6).map(lambda factor: round(factor * shipped, 6))
    return st.one_of(close, close, close, st.floats(), st.integers())


def entry(name: tuple[str, str]) -> st.SearchStrategy[tuple[tuple[str, str], float]]:
    """Strategy for a field and a value of it."""
    table, field = name
    value = st.integers(-1, 2) if field == "hand" else near(getattr(getattr(ROBOT, table), field))
    return st.tuples(st.just(name), value)


VALUES = st.lists(st.sampled_from(FIELDS).flatmap(entry), max_size=4).map(dict)


def loaded(values: dict[tuple[str, str], float]) -> RobotData | str:
    """Return the robot of a file with these values, or the message of the error."""
    tables: dict[str, str] = {}
    for (table, field), value in values.items():
        tables[table] = tables.get(table, "") + f"{field} = {value}\n"
    text = "".join(f"[{table}]\n{lines}" for table, lines in tables.items())
    with TemporaryDirectory() as folder:
        try:
            return robot_file.load(write(Path(folder), text))
        except WrongUsage as refusal:
            return refusal.message


@pytest.mark.no_cover
@settings(max_examples=40)
@given(VALUES)
def test_any_file_of_numbers_gives_a_working_robot_or_an_error_with_the_field(
    values: dict[tuple[str, str], float],
) -> None:
    robot = loaded(values)
    if isinstance(robot, str):
        assert any(f"[{table}] {field}" in robot for table, field in FIELDS), robot
        return
    planner = Planner(robot)
    for yaw, pitch, roll in itertools.product((-NEAR, 0.0, NEAR), repeat=3):
        planner.goal(PoseQuery(yaw=yaw, pitch=pitch, roll=roll), HOME)


def test_different_values_have_different_fingerprints(tmp_path: Path) -> None:
    other = robot_file.load(write(tmp_path, "[head]\nmass = 0.9\n"))
    assert robot_file.fingerprint(ROBOT) == robot_file.fingerprint(robot_file.load(None))
    assert robot_file.fingerprint(other) != robot_file.fingerprint(ROBOT)
