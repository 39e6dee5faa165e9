"""Pictures of the robots' eyes for the web sockets that show them; cameras work only while one does."""

from __future__ import annotations

from collections.abc import Callable, Hashable

from beatrix_zenoh.client import CameraImage
from beatrix_zenoh.client.session import Place
from beatrix_zenoh.contract.names import EYES
from gui.console.link.connection import Session
from gui.console.link.jobs import Jobs
from gui.console.link.pictures import CameraStream, Watcher

Camera = tuple[str, str, str]
"""Robot, side and eye."""
OnPicture = Callable[[Camera, CameraImage], None]


class Eyes:
    """Subscribes to the cameras that web sockets show; its methods run on the thread of the server's loop."""

    def __init__(self, session: Callable[[], Session | None], jobs: Jobs, call: Callable[..., None]) -> None:
        """Subscribe to nothing yet.

        Args:
            session: returns the session that all pages share, if there is one.
            jobs: begins and ends subscriptions.
            call: runs a function with its arguments on the server's loop; any thread may use it.
        """
        self._session, self._call = session, call
        self._viewers: dict[Hashable, tuple[list[Camera], OnPicture]] = {}
        """what each web socket shows, and the function that takes its pictures"""
        self._cameras = Watcher[Camera, CameraStream]("cameras", jobs, session, self._begin)
        self._watch()  # starts the thread of these jobs, which ends with the server

    def start(self, viewer: Hashable, place: Place, show: OnPicture, *, both: bool = True) -> list[Camera]:
        """Begin to send pictures of the left eye or both, and return their cameras; none if the robot is not online."""
        session, cameras = self._session(), [(*place, eye) for eye in EYES[: 1 + both]]
        if session is None or place not in session.monitor.present():
            return []
        self._viewers[viewer] = cameras, show
        self._watch()
        return cameras

    def end(self, viewer: Hashable) -> None:
        """Send no more pictures to a web socket; end subscriptions that no other one needs."""
        self._viewers.pop(viewer, None)
        self._watch()

    def close(self) -> None:
        """End all subscriptions; returns at once."""
        self._cameras.close()

    def _watch(self) -> None:
        self._cameras.watch(frozenset(camera for cameras, _ in self._viewers.values() for camera in cameras))

    def _begin(self, session: Session, camera: Camera) -> CameraStream:
        return CameraStream(session.client, camera, lambda _, image: self._call(self._show, camera, image))

    def _show(self, camera: Camera, image: CameraImage) -> None:
        for cameras, show in list(self._viewers.values()):
            if camera in cameras:
                show(camera, image)
