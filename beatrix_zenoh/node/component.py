"""The interface of the node's components."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

from beatrix_zenoh.bus import Sessions
from beatrix_zenoh.contract._generated.messages import CameraStatus


@dataclass
class StatusFields:
    """Fields of a Status under construction; `warnings` are sentences for the user, the most important first."""

    values: dict[str, object] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    cameras: list[CameraStatus] = field(default_factory=list)


class Component(Protocol):
    """A part of a node; overrides the methods that it needs. Its constructor starts no thread and does not wait.

    A node starts its components in the order of its list and closes them in reverse order. A new component needs a
    file, a line in `node.components`, and rows in schemas for its publications and queries.
    """

    def start(self, sessions: Sessions) -> None:  # noqa: ARG002
        """Start threads and declare keys."""
        return

    def contribute(self, status: StatusFields) -> None:  # noqa: ARG002
        """Add fields and warnings to a status; several threads call it, so it must be thread-safe and must not wait."""
        return

    def close(self) -> None:
        """End threads and reply to every open request; called even if `start` has failed.

        The node undeclares the keys later.
        """
        return
