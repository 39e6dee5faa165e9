"""A flood of requests to a robot."""

from __future__ import annotations

import threading
from typing import Self

from beatrix_zenoh import Robot
from beatrix_zenoh.bus import Query
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import PoseQuery


class Flood:
    """A client that sends targets as fast as Zenoh accepts them, without reading a reply."""

    def __init__(self, robot: Robot) -> None:
        self.sent = 0
        self._robot = robot
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._queries: list[Query] = []

    def _run(self) -> None:
        bus, key = self._robot.client.bus, keys.pose(*self._robot.place, self._robot.client.settings.who)
        while not self._over.is_set():
            query = codec.encode(PoseQuery(yaw=0.7 + 0.05 * (self.sent % 2)))
            self._queries.append(bus.query(key, query, codec.MSGPACK))
            self.sent += 1
            if len(self._queries) > 500:
                self._queries.pop(0).close()

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *exc: object) -> None:
        self._over.set()
        self._thread.join()
        for query in self._queries:
            query.close()
        self._robot.timeout_s = 10.0
        self._robot.info()  # waits, because it is answered after the queries that are still arriving
