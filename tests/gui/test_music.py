"""Music beside the sequence, and tones: what its state decides."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from gui_worlds import LEFT, NOD, UP, world
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from gui.console.state import sequence_timing as timing
from gui.console.state.actions import Play, UseSounds
from gui.console.state.intents import Choose, PlaySequence, UndoSequence
from gui.console.state.music import ChooseMusic, SetNote, SnapToBeat
from gui.console.state.saved import DURATION_MAX_S, Saved, load, save
from gui.console.state.state import State
from gui.console.state.world import MusicProgress, Trouble, World

SONG = "/music/song.wav"


def hearing(beat_s: float = 0.625) -> World:
    return replace(world(), music=MusicProgress(SONG, ready=True, beat_s=beat_s))


@given(
    st.floats(1 / 3, 1), st.lists(st.floats(0.1, DURATION_MAX_S - 1), min_size=3, max_size=3), st.booleans()
)
def test_snapped_poses_last_whole_beats_and_are_possible(
    beat_s: float, durations: list[float], loop: bool
) -> None:
    poses = tuple(
        structs.replace(pose, duration_s=seconds)
        for pose, seconds in zip((NOD, LEFT, UP), durations, strict=True)
    )
    state, heard = State(Saved(poses=poses)), hearing(beat_s)
    state.handle(Choose("loop", loop), heard)
    state.handle(SnapToBeat(), heard)
    snapped = state.saved.poses
    least = timing.shortest_of(poses, timing.HOME, timing.limits_of(heard), loop=loop)
    for pose, before_s, least_s in zip(snapped, durations, least, strict=True):
        count = pose.duration_s / beat_s
        assert count == pytest.approx(round(count))
        assert max(1, count) * beat_s >= least_s - 1e-6
        assert abs(pose.duration_s - before_s) <= beat_s / 2 + 1e-6 or pose.duration_s < least_s + beat_s
    assert timing.too_short(snapped, timing.HOME, timing.limits_of(heard), loop=loop) == {}
    state.handle(UndoSequence(), heard)
    assert state.saved.poses == poses


def test_music_and_tones_are_remembered_and_played(tmp_path: Path) -> None:
    state = State(Saved(poses=(NOD, LEFT)))
    assert state.handle(ChooseMusic(Path(SONG)), world()) == [UseSounds(on=True, music=SONG)]
    state.handle(SetNote("left", 3), world())
    state.handle(SetNote("nod", 9), world())
    file = tmp_path / "window.json"
    save(file, state.saved)
    again = State(load(file))
    assert UseSounds(on=True, music=SONG) in again.follow(hearing())
    assert [card.note for card in again.view(hearing()).sequence.cards] == [0, 3]
    assert again.view(hearing()).sequence.cards[0].beats == pytest.approx(3.2)
    (play,) = (action for action in again.handle(PlaySequence("sim"), hearing()) if isinstance(action, Play))
    assert play.notes == (0, 3)
    assert again.handle(Choose("sounds", value=False), hearing()) == [UseSounds(on=False, music=SONG)]
    assert again.handle(ChooseMusic(None), hearing()) == [UseSounds(on=False)]


def test_the_tempo_or_what_is_wrong_is_a_sentence() -> None:
    state = State(Saved(poses=(NOD,), music=SONG))
    missing = MusicProgress(SONG, trouble=Trouble("trouble.music_missing", slots={"file": "song.wav"}))
    for music, title, can in (
        (MusicProgress(), "No music yet", False),
        (MusicProgress(SONG), "Listening to song.wav for its beat", False),
        (MusicProgress(SONG, ready=True, beat_s=0.625), "96 beats a minute: song.wav", True),
        (MusicProgress(SONG, ready=True), "No steady beat in song.wav; it plays all the same", False),
        (missing, "The music song.wav cannot be read. Open it again from where it is now", False),
    ):
        view = state.view(replace(world(), music=music)).music
        assert view.title.startswith(title)
        assert view.snap.enabled is can
    assert state.view(replace(world(), music=missing)).last.startswith("The music song.wav cannot be read.")
    state.handle(SnapToBeat(), replace(world(), music=missing))
    assert state.saved.poses == (NOD,)
