"""A real robot, or a virtual board in its place: the firmware counts the positions of the arms."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from beatrix_zenoh.board.state import Port
from beatrix_zenoh.board.virtual import Firmware, RealTime, TimedPort
from beatrix_zenoh.contract._generated.robot import ROBOT, RobotData
from beatrix_zenoh.contract._generated.serial import TELEMETRY_PERIOD, Telemetry
from beatrix_zenoh.motion.gear import Gear
from beatrix_zenoh.node import ArmState, Component, Node
from beatrix_zenoh.node.node import RobotBody
from hw_node.cameras.camera import TEST_EYES
from hw_node.port import VIRTUAL, SerialPort, find

MakeSensor = Callable[[Node], Component]


class Hardware(RobotBody):
    """A robot with its board on the serial port `device`; empty: the board on USB."""

    side = "hw"
    sampling_s = TELEMETRY_PERIOD / 1000

    def __init__(
        self, device: str = "", robot: RobotData = ROBOT, sensors: Sequence[MakeSensor] = ()
    ) -> None:
        self._device, self._sensors = device, sensors
        self._gear = Gear(robot.drive)

    def open_port(self) -> Port:
        """Open the serial port; raises NoAnswer if there is no board."""
        return SerialPort(self._device or find(", or try `--port virtual:` for a virtual board"))

    def pose(self, telemetry: Telemetry, t_mono_ns: int) -> ArmState:
        """Return the arm angles that the firmware has counted; the robot has no angle sensors."""
        return ArmState(
            t_mono_ns=t_mono_ns,
            position=self._gear.to_rad(telemetry.position),
            velocity=self._gear.to_rad(telemetry.velocity),
            steps=telemetry.position,
        )

    def components(self, node: Node) -> list[Component]:
        """Return the sensors: cameras, microphones and others."""
        return [make(node) for make in self._sensors]


class VirtualHardware(Hardware):
    """A robot whose firmware runs on a virtual board in real time; by default its eyes show a test picture."""

    def __init__(
        self, name: str, robot: RobotData = ROBOT, sensors: Sequence[MakeSensor] = TEST_EYES
    ) -> None:
        super().__init__(VIRTUAL, robot, sensors)
        self._port = TimedPort(Firmware(boot=1, name=name), RealTime)

    def open_port(self) -> Port:
        """Return the port of the virtual board, which is always present."""
        return self._port

    def timed_port(self) -> TimedPort | None:
        """Return the port of the virtual board."""
        return self._port

    def close(self) -> None:
        """Stop the virtual board."""
        self._port.close()


def build(device: str, name: str, robot: RobotData, sensors: Sequence[MakeSensor]) -> Hardware:
    """Create the body for `device`, or for a virtual board, without opening a port."""
    if device == VIRTUAL:
        return VirtualHardware(name, robot, sensors)
    return Hardware(device, robot, sensors)
