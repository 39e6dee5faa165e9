"""Names that may stand in keys, and where they come from."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from beatrix_zenoh import Refused, names
from beatrix_zenoh.settings import DEFAULT_ENDPOINT, resolve


@pytest.fixture(autouse=True)
def in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_argument_beats_environment_beats_file_beats_default(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert resolve().connect == DEFAULT_ENDPOINT
    (tmp_path / "beatrix.toml").write_text('robot = "file"\nconnect = "tcp/1.2.3.4:1"\nwho = "seat1"\n')
    assert resolve().robot == "file"
    monkeypatch.setenv("BEATRIX_ROBOT", "environment")
    assert resolve().robot == "environment"
    assert resolve("argument").robot == "argument"
    assert (resolve().connect, resolve().who) == ("tcp/1.2.3.4:1", "seat1")


def test_without_any_name_user_and_host_make_one() -> None:
    assert names.PATTERN.fullmatch(resolve().robot)
    assert "-" in names.default_robot()


@pytest.mark.parametrize("text", ["robot = 3\n", 'colour = "red"\n', "robot = \n"])
def test_a_file_that_cannot_be_used_is_named(tmp_path: Path, text: str) -> None:
    (tmp_path / "beatrix.toml").write_text(text)
    with pytest.raises(Refused, match=r"beatrix\.toml"):
        resolve()


@pytest.mark.parametrize("name", ["", "Bea 1", "a/b", "*", "@x", "x" * 33, "ä"])
def test_a_name_that_cannot_stand_in_a_key_is_refused_with_one_that_can(name: str) -> None:
    with pytest.raises(Refused, match="for example") as refusal:
        names.check_name(name)
    assert names.PATTERN.fullmatch(refusal.value.message.split("'")[-2])


@given(st.text())
def test_tidy_always_gives_an_allowed_name(text: str) -> None:
    assert names.check_name(names.tidy(text))
