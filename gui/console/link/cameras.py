"""Subscriptions to those pictures of the selected robot that are visible in the window."""

from __future__ import annotations

from gui.console.link.connection import Session
from gui.console.link.pictures import OnImage, Pictures
from gui.console.link.worker import Worker


class Cameras(Worker):
    """Subscribes to wanted pictures when there is a session, and again when another robot is selected."""

    def __init__(self, on_image: OnImage) -> None:
        """Start the thread without subscriptions; `on_image` receives side and picture on threads of this object."""
        super().__init__("window-cameras")
        self._on_image = on_image
        self._wanted: frozenset[tuple[str, str]] = frozenset()
        self._pictures: Pictures | None = None

    def watch(self, wanted: frozenset[tuple[str, str]]) -> None:
        """Subscribe to exactly these cameras, pairs of side and eye; returns at once."""

        def apply() -> None:
            self._wanted = wanted
            if self._pictures is not None:
                self._pictures.watch(wanted)

        self.put(apply)

    def follow(self, session: Session) -> None:
        """Subscribe to the pictures of this session's robots from now on; returns at once."""

        def apply() -> None:
            self._end()
            self._pictures = Pictures(session.client, session.twin.name, self._on_image)
            self._pictures.watch(self._wanted)

        self.put(apply)

    def _end(self) -> None:
        if self._pictures is not None:
            self._pictures.close()
            self._pictures = None

    def close(self) -> None:
        """End the subscriptions and the thread; returns at once."""
        self.put(self._end)
        super().close()
