"""The files of the folder `static`: compressed once, at a path with the hash of all, so that browsers keep them."""

from __future__ import annotations

import gzip
import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Self

STATIC: Final = Path(__file__).parent / "static"
TYPES: Final = {
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
    ".png": "image/png",
    ".cur": "image/x-icon",
}
"""The suffixes of the files that are served."""


@dataclass(frozen=True)
class StaticFile:
    """One file as it is sent."""

    kind: str
    content: bytes
    compressed: bytes


class StaticFolder:
    """All files, by their path in the folder; no other path can be asked for."""

    def __init__(self, files: dict[str, StaticFile]) -> None:
        self.files = files
        digest = hashlib.sha256()
        for name, file in sorted(files.items()):
            digest.update(name.encode() + b"\0" + file.content)
        self.root = f"/static/{digest.hexdigest()[:12]}"
        """the path of the folder, which changes with each of its files"""

    @classmethod
    def read(cls) -> Self:
        """Read and compress all files."""
        found = {}
        for path in sorted(STATIC.rglob("*")):
            if path.suffix in TYPES:
                content = path.read_bytes()
                name = path.relative_to(STATIC).as_posix()
                found[name] = StaticFile(TYPES[path.suffix], content, gzip.compress(content, mtime=0))
        return cls(found)
