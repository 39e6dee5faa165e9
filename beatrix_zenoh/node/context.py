"""What the components of one node share, and the body of the node, which adds components of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from beatrix_zenoh.node.access import Access
from beatrix_zenoh.node.board_watch import BoardWatch
from beatrix_zenoh.node.controller import MotionController
from beatrix_zenoh.node.events import Diagnostics, NodeEvents
from beatrix_zenoh.node.interfaces import Component, HardwareInterface
from beatrix_zenoh.node.planner import Planner
from beatrix_zenoh.node.requests import RequestQueue
from beatrix_zenoh.node.snapshot import Snapshot


@dataclass(frozen=True)
class Context:
    """Objects that the components of one node share."""

    name: str
    side: str
    hardware: RobotBody
    planner: Planner
    access: Access
    events: NodeEvents
    diagnostics: Diagnostics
    queue: RequestQueue
    board_watch: BoardWatch
    controller: MotionController
    snapshot: Snapshot


class RobotBody(HardwareInterface, Protocol):
    """A robot with the components that only its kind has."""

    def components(self, context: Context) -> list[Component]:
        """Return the components that only this kind of robot has: previews, cameras."""
