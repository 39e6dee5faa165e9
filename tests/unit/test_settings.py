"""Settings and the names in them."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh import Refused
from beatrix_zenoh.contract import names
from beatrix_zenoh.settings import DEFAULT_ENDPOINT, resolve


@pytest.fixture(autouse=True)
def in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_an_argument_overrides_the_environment_which_overrides_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert resolve().connect == DEFAULT_ENDPOINT
    (tmp_path / "beatrix.toml").write_text('robot = "file"\nconnect = "tcp/1.2.3.4:1"\nwho = "seat1"\n')
    assert resolve().robot == "file"
    monkeypatch.setenv("BEATRIX_ROBOT", "environment")
    assert resolve().robot == "environment"
    assert resolve("argument").robot == "argument"
    assert (resolve().connect, resolve().who) == ("tcp/1.2.3.4:1", "seat1")


def test_cameras_are_read_from_file_or_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert resolve().cameras == ()
    (tmp_path / "beatrix.toml").write_text('camera_left = "pattern"\ncamera_right = "/dev/v4l/by-path/a"\n')
    assert resolve().cameras == ("left=pattern", "right=/dev/v4l/by-path/a")
    monkeypatch.setenv("BEATRIX_CAMERA_LEFT", "file:clip.avi")
    assert resolve().cameras[0] == "left=file:clip.avi"


def test_microphones_are_off_unless_file_or_environment_name_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert resolve().microphones == ""
    (tmp_path / "beatrix.toml").write_text('microphones = "USB Audio"\n')
    assert resolve().microphones == "USB Audio"
    monkeypatch.setenv("BEATRIX_MICROPHONES", "tone")
    assert resolve().microphones == "tone"


@pytest.mark.parametrize("text", ["robot = 3\n", 'colour = "red"\n', "robot = \n"])
def test_an_invalid_file_raises_an_error_with_its_path(tmp_path: Path, text: str) -> None:
    (tmp_path / "beatrix.toml").write_text(text)
    with pytest.raises(Refused, match=r"beatrix\.toml"):
        resolve()


@pytest.mark.parametrize("name", ["", "Bea 1", "a/b", "*", "@x", "x" * 33, "ä"])
def test_an_invalid_name_is_refused_with_a_valid_example(name: str) -> None:
    with pytest.raises(Refused, match="for example") as refusal:
        names.check_name(name)
    assert names.PATTERN.fullmatch(refusal.value.message.split("'")[-2])


@given(st.text())
def test_tidy_always_returns_a_valid_name(text: str) -> None:
    assert names.check_name(names.tidy(text))


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("Zoë", "zoe"),
        ("Jürgen Groß", "jurgen-gross"),
        ("Søren", "soren"),
        ("Łukasz", "lukasz"),
        ("Æthelred", "aethelred"),
        ("李", "beatrix"),
    ],
)
def test_names_in_latin_letters_lose_their_accents(text: str, name: str) -> None:
    assert names.tidy(text) == name
