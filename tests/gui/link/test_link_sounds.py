"""Music and tones of the link: files that are read, the track of a play, and the player's end."""

from __future__ import annotations

import sys
import wave
from pathlib import Path

import av
import numpy as np
import pytest
from gui_links import Linked
from robots import until

from beatrix_zenoh.client.choreography import ArmPose
from beatrix_zenoh.wav import Wav
from gui.console.link import sounds
from gui.console.link.jobs import Jobs
from gui.console.link.sounds import Sounds
from gui.console.state.actions import Play, SendStop, UseSounds
from gui.console.state.world import MusicProgress

RATE, BEAT_S = 44_100, 0.5


def song() -> np.ndarray:
    """Return five seconds of clicks, two a second, from 0.25 s on."""
    t_s = (np.arange(5 * RATE) / RATE - 0.25) % BEAT_S
    loud = np.where(np.arange(5 * RATE) < 0.25 * RATE, 0, 12_000 * np.exp(-t_s / 0.01))
    return (loud * np.sin(2 * np.pi * 700 * t_s)).astype("<i2")


def written(folder: Path, name: str) -> Path:
    """Write the song as a WAV or MP3 file."""
    file = folder / name
    if name.endswith(".wav"):
        with wave.open(str(file), "wb") as out:
            out.setparams((1, 2, RATE, 0, "NONE", ""))
            out.writeframes(song().tobytes())
    else:
        with av.open(str(file), "w") as container:
            stream = container.add_stream("libmp3lame", rate=RATE, layout="mono")
            frame = av.AudioFrame.from_ndarray(song()[None], format="s16p", layout="mono")
            frame.rate = RATE
            container.mux(stream.encode(frame))
            container.mux(stream.encode(None))
    return file


def read(file: Path) -> tuple[Sounds, MusicProgress]:
    found = Sounds(jobs := Jobs("test"))
    found.use(UseSounds(on=True, music=str(file)))
    until(lambda: found.progress().ready or found.progress().trouble is not None, "it is read", 30)
    jobs.close()
    return found, found.progress()


@pytest.mark.parametrize("name", ["song.wav", "song.mp3"])
def test_the_beat_of_a_file_is_found(tmp_path: Path, name: str) -> None:
    found, progress = read(written(tmp_path, name))
    assert progress.beat_s == pytest.approx(BEAT_S, rel=0.01)
    track = found.track([0.0, 1.0], (0, 6))
    assert track is not None
    with wave.open(str(track)) as heard:
        assert heard.getnframes() == pytest.approx(4.75 * RATE, abs=0.1 * RATE)
    track.unlink()
    found.use(UseSounds(on=False, music=str(tmp_path / name)))
    assert found.track([0.0], (6,)) is None


@pytest.mark.parametrize(
    ("name", "hidden", "key"),
    [
        ("gone.mp3", "", "missing"),
        ("bad.mp3", "", "format"),
        ("bad.wav", "", "format"),
        ("bad.mp3", "av", "mp3"),
    ],
)
def test_what_cannot_be_read_has_a_sentence(
    tmp_path: Path, name: str, hidden: str, key: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if hidden:
        monkeypatch.setitem(sys.modules, hidden, None)
    if "bad" in name:
        (tmp_path / name).write_bytes(b"no music" * 99)
    _, progress = read(tmp_path / name)
    assert progress.trouble is not None
    assert progress.trouble.key == f"trouble.music_{key}"


def test_tones_begin_at_their_times() -> None:
    silence = Wav(np.zeros((RATE, 1), np.int16), RATE)
    heard = sounds.with_tones(silence, [(0.5, 6), (2.0, 1)])
    assert not heard[: RATE // 2].any()
    for at_s, hertz in ((0.5, 440.0), (2.0, 261.6)):
        part = heard[round(at_s * RATE) :][: round(0.4 * RATE)]
        spectrum = np.abs(np.fft.rfft(part))
        assert spectrum.argmax() * RATE / len(part) == pytest.approx(hertz, abs=3)


def test_stop_ends_the_player_and_without_one_the_dance_goes_on(
    linked: Linked, monkeypatch: pytest.MonkeyPatch
) -> None:
    poses = (ArmPose(0.0, 2.0, 0.0, 0.0, 10.0), ArmPose(0.5, 0.0, 0.0, 0.0, 10.0))
    monkeypatch.setattr(sounds, "player", lambda _platform: ("no-such-player",))
    linked.do(Play(1, ("sim",), poses, notes=(1, 2)))
    assert linked.end_of(1, "sim").accepted
    trouble = linked.world.music.trouble
    assert trouble is not None
    assert trouble.key == "trouble.no_player"
    sleeps = (sys.executable, "-c", "import time; time.sleep(60)")
    monkeypatch.setattr(sounds, "player", lambda _platform: sleeps)
    linked.do(Play(2, ("sim",), poses, (ArmPose(0.0, 2.0, 0.0, 0.0, 10.0),), notes=(1, 2)))
    own = linked.link.moving.sounds
    until(lambda: own._player is not None, "it plays", 20)
    child = own._player
    assert child is not None
    linked.do(SendStop(3))
    assert child.poll() is not None
    assert not linked.end_of(2, "sim").accepted
