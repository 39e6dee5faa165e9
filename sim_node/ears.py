"""The simulated microphones: a thread that publishes what both ears hear while a client subscribes."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.robot import RobotData
from beatrix_zenoh.node import Node, SoundBlock, microphones_publisher
from beatrix_zenoh.node.sensor_thread import Sensor
from beatrix_zenoh.node.sensors import RATE, TITLE, BlockClock, to_pcm
from sim_node.hearing import Ears, Hearing, PlayingSound


class SimulatedSound:
    """What both ears hear, as a `SensorSource`."""

    name: Final = "simulation"

    def __init__(
        self, robot: RobotData, hearing: Callable[[], Hearing], playing: Callable[[], PlayingSound | None]
    ) -> None:
        self._hearing, self._playing = hearing, playing
        self._ears, self._clock = Ears(robot), BlockClock()

    def trouble(self) -> str:
        """Return an empty text: simulated ears are always present."""
        return ""

    def open(self) -> None:
        """Restart the clock and the echo."""
        self._clock.restart()
        self._ears.restart()

    def next(self, timeout_s: float) -> SoundBlock | None:
        """Wait for the next block and return it; None if it is complete after `timeout_s`."""
        dropped = self._clock.dropped
        begin_ns = self._clock.wait(timeout_s)
        if begin_ns is None:
            return None
        if self._clock.dropped != dropped:
            self._ears.restart()
        sound = self._playing()
        began = 0.0 if sound is None else (begin_ns / 1e9 - sound.began_s) * RATE
        signal = None if sound is None else sound.emitted
        pcm = to_pcm(self._ears.block(self._hearing(), signal, began))
        return SoundBlock(pcm, begin_ns, self.name, self._clock.dropped)

    def close(self) -> None:
        """Do nothing: there are no resources to free."""


class SimulatedMicrophones(Sensor[SoundBlock]):
    """Publishes the sound of both ears; without a subscriber its thread sleeps."""

    check_s = None

    def __init__(
        self,
        node: Node,
        robot: RobotData,
        hearing: Callable[[], Hearing],
        playing: Callable[[], PlayingSound | None],
    ) -> None:
        """Store the arguments; `start` starts the thread.

        Args:
            node: the node whose name the sound has.
            robot: values of the robot.
            hearing: returns ears, source and arms at the last step of the physics.
            playing: returns the sound of the source, None for silence.
        """
        source, wake = SimulatedSound(robot, hearing, playing), threading.Event()
        # Simulated ears hear no person, so no event says that they are on.
        key = keys.microphones(node.name, node.side)
        publisher = microphones_publisher(key, node.events, source.name, wake.set, announce=False)
        super().__init__(TITLE, source, publisher, wake, "")

    def start_thread(self) -> threading.Thread:
        """Start the thread."""
        return threads.start(self.run, "ears")
