"""The gallery of a class: photos and films that pupils have shown, as files, one folder for each seat."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path
from typing import Final

from tornado import web

from beatrix_zenoh import files
from beatrix_zenoh.contract.names import TEACHER
from gui.page import protection
from gui.page.handlers import NOTHING, Guarded

BYTES_MAX: Final = 5_000_000
"""Largest photo or film: a film of a minute, see `BITS` of show.js. Then a seat has 60 MB at most."""
SHOWN_MAX: Final = 12
"""Largest number of pictures of a seat: the oldest one goes."""
KINDS: Final = {".png": "image/png", ".mp4": "video/mp4", ".webm": "video/webm"}


def ending_of(content: bytes) -> str:
    """Return the ending of a photo or film by its content; empty: it is neither."""
    if content.startswith(b"\x89PNG\r\n\x1a\n"):
        return ".png"
    if content[4:8] == b"ftyp":
        return ".mp4"
    return ".webm" if content.startswith(b"\x1a\x45\xdf\xa3") and b"webm" in content[:64] else ""


class Gallery:
    """The pictures of all seats: `<folder>/<seat>/<ms since 1970>.png`, .mp4 or .webm."""

    def __init__(self, folder: Path) -> None:
        """Set the folder; it is made when the first picture is shown."""
        self.folder = folder
        self.sending: set[str] = set()
        """the seats whose pictures are arriving: one at a time, as they arrive in memory"""

    def listed(self) -> list[tuple[str, str]]:
        """Return seats and files of all pictures, the newest first."""
        found = [path for path in self.folder.glob("*/*") if path.suffix in KINDS and path.stem.isdecimal()]
        return [(path.parent.name, path.name) for path in sorted(found, key=lambda path: path.name)[::-1]]

    def keep(self, seat: str, content: bytes, ending: str) -> None:
        """Write a picture of a seat, and delete its oldest ones; raises OSError."""
        folder = self.folder / seat
        folder.mkdir(parents=True, exist_ok=True)
        with files.replace_when_complete(folder / f"{time.time_ns() // 1_000_000}{ending}") as unfinished:
            unfinished.write_bytes(content)
        for file in [file for owner, file in self.listed() if owner == seat][SHOWN_MAX:]:
            (folder / file).unlink(missing_ok=True)

    def path(self, seat: str, file: str) -> Path | None:
        """Return the path of a picture; None if there is none of this name, so that no name leads to another folder."""
        return self.folder / seat / file if (seat, file) in self.listed() else None


class OfClass(Guarded):
    """A handler for browsers with a seat of a class."""

    def initialize(self, gallery: Gallery) -> None:
        """Take the pictures of all seats; nothing has arrived of a new one."""
        self.gallery, self._content, self._sends = gallery, bytearray(), False

    def prepare(self) -> None:
        """Refuse other browsers."""
        super().prepare()
        self.seat = self.visitor or ""
        if not self._finished and not (self.seat and self.context.login.shown(self.seat)):
            self.reject(403, protection.NO_COOKIE)


@web.stream_request_body
class GalleryList(OfClass):
    """The list of all pictures, and the way of new ones into it."""

    def prepare(self) -> None:
        """Refuse a second picture of a seat before the first one has arrived; Tornado refuses a larger one."""
        super().prepare()
        if self._finished or self.request.method != "POST":
            return
        if self.seat in self.gallery.sending:
            self.reject(409, "page.show_failed")
        else:
            self.request.connection.set_max_body_size(BYTES_MAX)  # type: ignore[union-attr]
            self._sends = True
            self.gallery.sending.add(self.seat)

    def data_received(self, chunk: bytes) -> None:
        """Take a part of a picture."""
        self._content += chunk

    def get(self) -> None:
        """Send the list: seat, file and name of the pupil of each picture, and whether this browser may delete them."""
        shown = [(seat, file, self.context.login.shown(seat)) for seat, file in self.gallery.listed()]
        self.write({"shown": shown, "teacher": self.seat == TEACHER})

    def post(self) -> None:
        """Keep a picture of this seat; reply with the key of a sentence."""
        content, key = bytes(self._content), "page.show_failed"
        with contextlib.suppress(OSError):  # the disk is full
            if ending := ending_of(content):
                self.gallery.keep(self.seat, content, ending)
                key = "page.shown"
        self.finish(key)

    def on_finish(self) -> None:
        """Let the next picture come."""
        if self._sends:
            self.gallery.sending.discard(self.seat)

    on_connection_close = on_finish


class GalleryPicture(OfClass):
    """One picture."""

    def get(self, seat: str, file: str) -> None:
        """Send it."""
        path = self.gallery.path(seat, file)
        if path is None:
            self.reject(404, NOTHING)
            return
        self.set_header("Content-Type", KINDS[path.suffix])
        self.finish(path.read_bytes())

    def delete(self, seat: str, file: str) -> None:
        """Delete it, for the teacher."""
        path = self.gallery.path(seat, file)
        if self.seat != TEACHER or path is None:
            self.reject(403, NOTHING)
            return
        with contextlib.suppress(OSError):
            path.unlink()
        self.finish()
