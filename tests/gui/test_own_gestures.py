"""Gestures of the user: files with an emoji, and what the window does with them."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import pytest
from gui_worlds import refusal_of, world
from hypothesis import given
from hypothesis import strategies as st
from present import present
from robots import until

from beatrix_zenoh.blocks.program import WrongProgram
from beatrix_zenoh.blocks.program import read as read_blocks
from beatrix_zenoh.client import own_gestures as files
from beatrix_zenoh.client.choreography import ArmPose, choreography, load, shipped
from beatrix_zenoh.client.motion_file import parse
from beatrix_zenoh.contract.errors import wrong_usage
from gui.console.link.jobs import Jobs
from gui.console.link.outcomes import WindowError
from gui.console.link.own_gestures import OwnGestures, read, write
from gui.console.state import gestures
from gui.console.state.actions import KeepGesture
from gui.console.state.intents import Choose, Intent, SaveGesture
from gui.console.state.memory import Memory
from gui.console.state.own_gestures import EMOJI, OpenGesture
from gui.console.state.saved import Choices, Saved, SavedPose
from gui.console.state.sequence import POSES_MAX
from gui.console.state.state import State
from gui.console.state.world import OwnGesture

TEXT = "t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s\n0,10,0,0,30\n1,0,0,0,\n"
POSES = (SavedPose("left", 20.0, 20.0, 20.0, 2.0), SavedPose("up", -8.0, 4.0, 4.0, 2.0))
WINK = OwnGesture("wink", "😜", files.with_emoji(TEXT, "😜"))
BROKEN = OwnGesture("broken", "", "", wrong_usage("broken.csv, line 3: t_s is empty."))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of gestures, in a home folder of this test."""
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "beatrix-programs/gestures").mkdir(parents=True)
    return files.folder()


@given(st.sampled_from(EMOJI), st.sampled_from(EMOJI))
def test_an_emoji_is_a_comment_that_can_be_changed(first: str, second: str) -> None:
    text = files.with_emoji(TEXT, first)
    for emoji, changed in ((first, text), (second, files.with_emoji(text, second))):
        assert files.emoji_of(changed) == emoji
        assert choreography(parse(changed, "wink")).steps == choreography(parse(TEXT, "wink")).steps
    assert files.emoji_of(f'"# emoji: {first}",,,,\n{TEXT}') == first  # as a spreadsheet saves it
    assert files.emoji_of(TEXT) == ""


def test_play_finds_a_gesture_by_its_name_after_shipped_ones(folder: Path) -> None:
    for name in ("wink", "happy"):
        (folder / f"{name}.csv").write_text(WINK.text, encoding="utf-8")
    assert len(load("wink").steps) == 2
    assert load("happy") == shipped("happy")
    for wrong in ("../gestures/wink", "con", "wink.csv"):
        assert files.file_of(wrong) is None


@pytest.mark.parametrize(
    ("name", "text", "why"),
    [
        ("wink", TEXT.replace("1,0,0,0,", "1,0,zero,0,"), "line 3"),
        ("wink", "", "begin with the names of the columns"),
        ("wink", TEXT.replace("_s,yaw", "_s,jaw"), "line 1"),
        ("wink", "#" * (files.LARGEST_BYTES + 1), "longer than"),
        ("wink!", TEXT, "Rename the file"),
        ("Yes", TEXT, "is a shipped gesture"),
    ],
)
def test_a_wrong_file_is_named_with_its_line(folder: Path, name: str, text: str, why: str) -> None:
    file = folder / f"{name}.csv"
    file.write_text(text, encoding="utf-8")
    found = read(file)
    assert found.wrong is not None
    assert file.name in found.wrong.message
    assert why in found.wrong.message


def test_files_are_written_renamed_and_deleted_and_none_is_lost(folder: Path) -> None:
    def there() -> dict[str, str]:
        return {
            str(path.relative_to(folder)): files.emoji_of(path.read_text("utf-8"))
            for path in folder.rglob("*.csv")
        }

    write(KeepGesture(1, "wink", WINK.text))
    write(KeepGesture(2, "wink", files.with_emoji(TEXT, "😎")))
    assert there() == {"wink.csv": "😎", "deleted/wink.csv": "😜"}
    write(KeepGesture(3, "nod", WINK.text, "wink"))
    assert there() == {"nod.csv": "😜", "deleted/wink.csv": "😎"}
    write(KeepGesture(4, "", "", "nod"))
    assert there() == {"deleted/nod.csv": "😜", "deleted/wink.csv": "😎"}
    with pytest.raises(WindowError, match="no_write"):
        write(KeepGesture(5, "", "", "nod"))


def test_a_file_that_another_program_writes_appears_by_itself(folder: Path) -> None:
    jobs = Jobs("test")
    own = OwnGestures(jobs, lambda _: None)
    try:
        assert own.newest(time.monotonic()) == ()
        (folder / "wink.csv").write_text(WINK.text, encoding="utf-8")
        until(lambda: own.newest(time.monotonic()) == (WINK,), "the gesture is found")
    finally:
        jobs.close()
        jobs.join(time.monotonic() + 5)


def test_a_largest_number_of_gestures_can_be_renamed_and_replaced() -> None:
    own = [OwnGesture(f"g{number}", "", TEXT) for number in range(files.MOST)]
    for intent in (SaveGesture("new", "😜", old="g1"), SaveGesture("g1", "😜")):
        assert kept(State(Saved(poses=POSES)), intent, *own).instead == "g1"
    state, now = State(Saved(poses=POSES)), world(gestures=tuple(own))
    assert state.handle(SaveGesture("new", "😜"), now) == []
    assert "Delete one first" in present(state.view(now).gestures.refusal).text


def test_a_seat_has_a_folder_of_its_own_besides_the_common_ones(folder: Path, tmp_path: Path) -> None:
    for name in ("wink", "nod"):
        (folder / f"{name}.csv").write_text(WINK.text, encoding="utf-8")
    jobs, seat = Jobs("test"), tmp_path / "ana"
    own = OwnGestures(jobs, lambda _: None, (seat,))
    try:
        own.keep(KeepGesture(1, "wink", files.with_emoji(TEXT, "😎")))
        until(lambda: len(own.newest(time.monotonic())) == 2, "the gestures are found")
        found = {one.name: (one.emoji, one.common) for one in own.newest(time.monotonic())}
        assert found == {"nod": ("😜", True), "wink": ("😎", False)}
    finally:
        jobs.close()
        jobs.join(time.monotonic() + 5)
    assert files.file_of("wink", seat) == seat / "wink.csv"
    assert files.file_of("nod", seat) == folder / "nod.csv"
    assert (folder / "wink.csv").read_text(encoding="utf-8") == WINK.text
    (common,) = gestures.view(Memory(Choices(), ()), world(gestures=(replace(WINK, common=True),))).own
    assert common.menu == (), "no page changes a common one"


def kept(state: State, intent: Intent, *own: OwnGesture) -> KeepGesture:
    (action,) = state.handle(intent, world(gestures=own))
    assert isinstance(action, KeepGesture)
    return action


def test_a_sequence_becomes_a_gesture_that_ends_at_home_and_opens_again() -> None:
    state = State(Saved(poses=POSES))
    saved = kept(state, SaveGesture("wink", "😜"))
    steps = [step for _, step in choreography(parse(saved.text, "wink")).steps]
    assert all(isinstance(step, ArmPose) for step in steps)
    assert [(step.at, str(step)) for step in steps][2:] == [(4.0, "arms short +0°, middle +0°, long +0°")]
    assert (saved.name, saved.instead, files.emoji_of(saved.text)) == ("wink", "", "😜")
    own = OwnGesture("wink", "😜", saved.text)
    state.handle(Choose("simple", value=True), world())
    state.handle(OpenGesture("wink"), world(gestures=(own,)))
    assert state.saved.poses[:2] == POSES
    assert not state.choices.simple, "the simple window shows no sequence"
    again = kept(state, SaveGesture("Wink", "😜"), own)
    assert (again.text, again.instead) == (saved.text, "wink")


def test_a_gesture_is_renamed() -> None:
    renamed = kept(State(), SaveGesture("nod", "😎", old="wink"), WINK)
    assert (renamed.name, renamed.instead, files.emoji_of(renamed.text)) == ("nod", "wink", "😎")


FAR = "t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s\n0,0,89,0,30\n"
LONG = TEXT.splitlines()[0] + "".join(f"\n{second},1,0,0,30" for second in range(POSES_MAX + 2))


@pytest.mark.parametrize(
    ("own", "english", "german"),
    [
        (OwnGesture("far", "", FAR), "lean", "Kopf"),
        (OwnGesture("long", "", LONG), "has 102 poses", "102"),
        (BROKEN, "line 3: t_s is empty", "broken.csv"),
    ],
)
def test_a_gesture_that_cannot_be_a_sequence_is_explained(own: OwnGesture, english: str, german: str) -> None:
    state, now = State(Saved(poses=POSES)), world(gestures=(own,))
    for code, words in (("en", english), ("de", german)):
        state.handle(Choose("language", code), now)
        state.handle(OpenGesture(own.name), now)
        assert words in refusal_of(state, now)
    assert state.saved.poses == POSES


@pytest.mark.parametrize(
    ("intent", "why"),
    [
        (SaveGesture("", "😜"), "cannot be a name"),
        (SaveGesture("../x", "😜"), "cannot be a name"),
        (SaveGesture("Happy", "😜"), "a gesture of BEATRIX"),
    ],
)
def test_a_name_that_cannot_be_used_is_refused(intent: Intent, why: str) -> None:
    state, now = State(Saved(poses=POSES)), world(gestures=(WINK, BROKEN))
    assert state.handle(intent, now) == []
    assert why in present(state.view(now).gestures.refusal).text


@pytest.mark.parametrize(
    ("name", "known"), [("wink", True), ("happy", True), ('x")', False), ("../x", False)]
)
def test_a_block_may_name_a_gesture_of_the_user(name: str, known: bool) -> None:
    text = '{"blocks":{"blocks":[{"type":"start","next":{"block":{"type":"gesture","fields":{"NAME":%s}}}}]}}'
    quoted = '"' + name.replace('"', '\\"') + '"'
    if known:
        assert read_blocks(text % quoted).blocks[0].fields == {"NAME": name}
    else:
        with pytest.raises(WrongProgram):
            read_blocks(text % quoted)
