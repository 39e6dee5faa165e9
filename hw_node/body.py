"""The body of a real robot: what the firmware counts is where the arms are."""

from __future__ import annotations

from beatrix_zenoh._generated.messages import Fault, PlantStatus
from beatrix_zenoh._generated.robot import ROBOT, RobotData
from beatrix_zenoh._generated.serial import Move, MoveStraight, Telemetry
from beatrix_zenoh.board.board import Port
from beatrix_zenoh.board.virtual import Firmware, RealTimeTicker, VirtualBoard
from beatrix_zenoh.drive import Gear
from beatrix_zenoh.node import Pose, Preview
from hw_node.port import VIRTUAL, SerialPort, find


class Hardware:
    """A board on a serial port: `device`, or the one found on USB if empty."""

    twin = "hw"

    def __init__(self, device: str = "", robot: RobotData = ROBOT) -> None:
        self._device = device
        self._gear = Gear(robot.drive)

    def open_port(self) -> Port:
        """Open the serial port; NoAnswer if there is no board now."""
        return SerialPort(self._device or find(", or try `--port virtual:` for a board in software"))

    def pose(self, telemetry: Telemetry) -> Pose:
        """Arms as the firmware counts: the robot has no angle sensors."""
        return Pose(self._gear.to_rad(telemetry.position), self._gear.to_rad(telemetry.velocity))

    def straighten(self) -> None:
        """A person has set the head upright before."""

    def preview(self, move: Move | MoveStraight) -> Preview | None:  # noqa: ARG002
        """No copy of the real thing."""
        return None

    def plant(self) -> PlantStatus | None:
        """Real physics reports nothing."""
        return None

    def fault(self) -> Fault:
        """Only what the board itself tells."""
        return Fault.NONE

    def close(self) -> None:
        """Nothing besides the port, which the board frees."""


class VirtualHardware(Hardware):
    """The same firmware on a virtual board in real time: a robot without a robot."""

    def __init__(self, name: str, robot: RobotData = ROBOT) -> None:
        super().__init__(VIRTUAL, robot)
        self._board = VirtualBoard(Firmware(boot=1, name=name))
        self._ticker = RealTimeTicker(self._board)

    def open_port(self) -> Port:
        """The virtual board; always there."""
        return self._board

    def close(self) -> None:
        """Stop its clock."""
        self._ticker.close()
        self._board.close()


def build(device: str, name: str, robot: RobotData = ROBOT) -> Hardware:
    """The body on `device`, or on a virtual board; no port is opened yet."""
    return VirtualHardware(name, robot) if device == VIRTUAL else Hardware(device, robot)
