"""Pictures of the eyes for pages: one subscription for each eye that any page shows, and only the newest picture."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.client import CameraImage, Client, Subscription
from beatrix_zenoh.client.subscription import images
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError

Camera = tuple[str, str, str]
"""Robot, side and eye."""
RETRY_S: Final = 1.0
"""Time between attempts to open the session for pictures while no router answers."""


class Eye:
    """The subscription to one camera, and its newest picture."""

    def __init__(self, client: Client, camera: Camera, changed: Callable[[Camera], object]) -> None:
        """Start a thread that subscribes, and calls `changed` for each picture."""
        self.newest: CameraImage | None = None
        self._client, self._camera, self._changed = client, camera, changed
        self._ended = threading.Event()
        self._lock = threading.Lock()
        self._subscription: Subscription[CameraImage] | None = None
        threads.start(self._run, f"web-{'-'.join(camera)}")

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                pictures = images(self._client, *self._camera, timeout_s=None, length=1)
                with self._lock:
                    self._subscription = pictures
                if self._ended.is_set():  # `end` was called meanwhile
                    pictures.close()
                for picture in pictures:
                    self.newest = picture
                    self._changed(self._camera)
                return
            except BeatrixError as error:
                if error.reason is Reason.SHUTDOWN:
                    return
                self._ended.wait(RETRY_S)

    def end(self) -> None:
        """End the subscription, so that the camera can switch off; may wait for the router."""
        self._ended.set()
        with self._lock:
            subscription = self._subscription
        if subscription is not None:
            subscription.close()
