"""Files that are written completely or not at all, also on a full disk."""

from __future__ import annotations

import codecs
import contextlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from beatrix_zenoh import account, class_file, settings
from beatrix_zenoh.classroom import router_file
from beatrix_zenoh.client import choreography, motion_file
from beatrix_zenoh.contract.errors import Refused, WrongUsage
from beatrix_zenoh.files import new_file
from beatrix_zenoh.motion import robot_file
from gui.console.state import saved

resource = pytest.importorskip("resource", reason="Windows has none")
SMALL = 2048
"""Largest file on the full disk, bytes."""


@contextmanager
def full_disk() -> Iterator[None]:
    """Limit the size of files in this block; Python raises OSError as on a full disk.

    Not a fixture: coverage writes its data between the phases of a test.
    """
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (SMALL, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_on_a_full_disk_an_existing_file_remains_and_no_incomplete_one_is_left(tmp_path: Path) -> None:
    path = tmp_path / "demo.rrd"
    path.write_text("old")
    with full_disk(), pytest.raises(Refused, match="cannot be written"), new_file(path) as unfinished:
        unfinished.write_bytes(bytes(2 * SMALL))
    assert {found.name: found.read_text() for found in tmp_path.iterdir()} == {"demo.rrd": "old"}


def test_an_existing_file_is_replaced_by_a_complete_one(tmp_path: Path) -> None:
    path = tmp_path / "demo.rrd"
    path.write_text("old")
    with new_file(path) as unfinished:
        unfinished.write_text("new")
    assert {found.name: found.read_text() for found in tmp_path.iterdir()} == {"demo.rrd": "new"}


# -- text files that people write, in the encodings and with the line ends that their editors writ--


def settings_in(path: Path) -> settings.Settings:
    """Return the settings of a program that is started in the folder of this beatrix.toml."""
    with contextlib.chdir(path.parent):
        return settings.resolve()


def refusal(read: Callable[[Path], object]) -> Callable[[Path], str]:
    """Return a function that returns the refusal of a file's content, which shows that its text was read."""

    def read_refused(path: Path) -> str:
        with pytest.raises(WrongUsage) as refused:
            read(path)
        if "UTF-8" in refused.value.message:
            raise refused.value
        return refused.value.message

    return read_refused


KINDS: dict[str, tuple[str, Callable[[Path], object]]] = {
    "beatrix.toml": ('# Küche\nrobot = "bea7"\n', settings_in),
    "account.toml": ('# Küche\nname = "ana"\ncolour = "red"\n', refusal(account.load)),
    "class.toml": ('name = "8b" # Küche\naddresses = ["127.0.0.1"]\nseats = 2\n', class_file.read),
    "router.toml": ('# Küche\nrole = "router"\n', refusal(router_file.load)),
    "robot.toml": ("# Küche\n[limits]\ntilt_max = 20.0\n", robot_file.load),
    "path.csv": ("# Küche\nt_s,yaw_deg,pitch_deg,roll_deg\n0,0,0,0\n1,5,0,0\n", motion_file.read),
    "dance.csv": ("t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s,figure\n0,5,0,0,20,Küche\n", choreography.load),
    "window.json": (
        '{\n"speed": 20,\n"poses": [{"name": "Küche", "short": 1, "middle": 2, "long": 3}]}\n',
        saved.load,
    ),
}
"""Each kind of file: an example of its text, and the function that reads it."""
READ: dict[str, Callable[[str], bytes]] = {
    "UTF-8": lambda text: text.encode(),
    "UTF-8 with byte order mark": lambda text: text.encode("utf-8-sig"),
    "CRLF": lambda text: text.replace("\n", "\r\n").encode(),
    "CRLF with byte order mark": lambda text: text.replace("\n", "\r\n").encode("utf-8-sig"),
}
REFUSED: dict[str, Callable[[str], bytes]] = {
    "UTF-16": lambda text: codecs.BOM_UTF16_LE + text.encode("utf-16-le"),
    "UTF-16 without mark": lambda text: text.encode("utf-16-be"),
    "Latin-1": lambda text: text.encode("latin-1"),
}


@pytest.mark.parametrize("encoding", READ)
@pytest.mark.parametrize("kind", KINDS)
def test_a_file_is_read_with_byte_order_mark_and_with_line_ends_of_windows(
    kind: str, encoding: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("BEATRIX_ROBOT", raising=False)
    text, read = KINDS[kind]
    path = tmp_path / kind
    path.write_bytes(text.encode())
    expected = read(path)
    path.write_bytes(READ[encoding](text))
    assert read(path) == expected


@pytest.mark.parametrize("encoding", REFUSED)
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "window.json"])
def test_the_refusal_of_another_encoding_names_the_cure(kind: str, encoding: str, tmp_path: Path) -> None:
    text, read = KINDS[kind]
    path = tmp_path / kind
    path.write_bytes(REFUSED[encoding](text))
    with pytest.raises(
        WrongUsage, match=r"is not text in UTF-8: save it again as .* with the encoding UTF-8\.$"
    ):
        read(path)
