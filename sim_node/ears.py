"""The simulated microphones: a thread that publishes what both ears hear while a client subscribes."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.robot import RobotData
from beatrix_zenoh.node import Component, Node, SoundBlock, StatusFields, microphones_publisher
from beatrix_zenoh.node.sensors import RATE, BlockClock, to_pcm
from sim_node.hearing import Ears, Hearing
from sim_node.sounds import PlayingSound

SOURCE: Final = "simulation"
WAIT_S: Final = 0.2
RETRY_S: Final = 1.0
FAILED: Final = "The simulated ears have failed; the log of the simulation shows why. They are tried again."
log = logging.getLogger(__name__)


class SimulatedMicrophones(Component):
    """Publishes the sound of both ears; without a subscriber its thread sleeps."""

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
        self._hearing, self._playing = hearing, playing
        self._ears, self._clock = Ears(robot), BlockClock()
        self._wake, self._closed = threading.Event(), False
        # Simulated ears hear no person, so no event says that they are on.
        key = keys.microphones(node.name, node.side)
        self._publisher = microphones_publisher(key, node.events, SOURCE, self._wake.set, announce=False)
        self._thread: threading.Thread | None = None

    def start(self, sessions: Sessions) -> None:
        self._publisher.start(sessions)
        self._publisher.report("")
        self._thread = threads.start(self._run, "ears")

    def contribute(self, status: StatusFields) -> None:
        self._publisher.contribute(status)

    def _run(self) -> None:
        while not self._closed:
            self._wake.clear()
            if not self._publisher.subscribed:
                self._wake.wait()
                continue
            try:
                self._publish()
            except Exception:  # a bug here must not end the simulation
                log.exception("The simulated ears have failed.")
                self._publisher.report(FAILED)
                self._wake.wait(RETRY_S)
            finally:
                self._publisher.ended()

    def _publish(self) -> None:
        self._clock.restart()
        self._ears.restart()
        while self._publisher.subscribed and not self._closed:
            dropped = self._clock.dropped
            begin_ns = self._clock.wait(WAIT_S)
            if begin_ns is None:
                continue
            if self._clock.dropped != dropped:
                self._ears.restart()
            sound = self._playing()
            began = 0.0 if sound is None else (begin_ns / 1e9 - sound.began_s) * RATE
            signal = None if sound is None else sound.emitted
            pcm = to_pcm(self._ears.block(self._hearing(), signal, began))
            self._publisher.publish(SoundBlock(pcm, begin_ns, SOURCE, self._clock.dropped))

    def close(self) -> None:
        """End the thread."""
        self._closed = True
        self._wake.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)
