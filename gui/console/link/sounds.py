"""Music and tones beside a sequence: the beats of a file, and a player of the system as a child process.

Qt's own player needs a package that Debian does not install with Qt (libpulse-mainloop-glib0), so each system's player
plays one file, which has the music from its first beat and the tones at their times.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import threading
import wave
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from gui.console.link.jobs import Jobs
from gui.console.state.actions import UseSounds
from gui.console.state.saved import DURATION_MAX_S
from gui.console.state.world import MusicProgress, Trouble

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from beatrix_zenoh.wav import Wav

    Samples = npt.NDArray[np.int16]

LONGEST_S: Final = 600.0
"""Longest music that is read: 60 MB."""
RATE: Final = 44_100
"""Rate of tones without music, and of decoded music (1/s)."""
TONE_S: Final = 0.45
FREQUENCIES: Final = (261.63, 293.66, 329.63, 349.23, 392.0, 440.0, 493.88, 523.25)
"""c' to c'' (Hz)."""
PLAYERS: Final = (("pw-play",), ("paplay",), ("aplay", "-q"), ("afplay",), ("ffplay", "-nodisp", "-autoexit"))
WINDOWS: Final = "import sys, winsound; winsound.PlaySound(sys.argv[1], winsound.SND_FILENAME)"
END_S: Final = 0.5
"""Time in which a killed player is gone."""


class Sounds:
    """Reads the music, and plays one file at a time; any thread may call the methods, and only `track` takes long."""

    def __init__(self, jobs: Jobs) -> None:
        """Start nothing yet."""
        self._jobs, self._lock = jobs, threading.Lock()
        self._on = True
        self._tune: Wav | None = None
        """the music from its first beat"""
        self._player: subprocess.Popen[bytes] | None = None
        self._progress = MusicProgress()

    def progress(self) -> MusicProgress:
        """Return what is known of the music, and whether the player has failed."""
        with self._lock:
            if self._player is not None and self._player.poll():
                self._fail()
        return self._progress

    def use(self, action: UseSounds) -> None:
        """Read the music if it is another file, and be silent if sounds are off."""
        self._on = action.on
        if not action.on:
            self.silence()
        if action.music != self._progress.file:
            self._tune, self._progress = None, MusicProgress(action.music)
            if action.music:
                self._jobs.put("music", lambda: self._read(action.music))

    def _read(self, file: str) -> None:
        from beatrix_zenoh import beats  # noqa: PLC0415  # numpy would delay the window

        name, tune = Path(file).name, None
        try:
            sound = decoded(Path(file))
            steady = beats.find(sound.samples[:, 0], sound.rate)
        except (OSError, ImportError, ValueError) as error:
            kinds = {OSError: "missing", ImportError: "mp3", ValueError: "format"}
            key = next(key for kind, key in kinds.items() if isinstance(error, kind))
            trouble = Trouble(f"trouble.music_{key}", detail=str(error), slots={"file": name})
            found = MusicProgress(file, trouble=trouble)
        else:
            first_s, beat_s = steady or (0.0, 0.0)
            tune = sound._replace(samples=sound.samples[round(first_s * sound.rate) :])
            found = MusicProgress(file, ready=True, beat_s=beat_s)
        if self._progress.file == file:  # the user may have chosen another one meanwhile
            self._tune, self._progress = tune, found

    def track(self, begins_s: Sequence[float], notes: Sequence[int]) -> Path | None:
        """Write music and tones of a play, whose poses begin at these times, to a file to delete; None: silence."""
        import numpy as np  # noqa: PLC0415

        from beatrix_zenoh.wav import Wav  # noqa: PLC0415

        tune, tones = self._tune, [(at_s, note) for at_s, note in zip(begins_s, notes, strict=False) if note]
        if not self._on or (tune is None and not tones):
            return None
        sound = Wav(np.zeros((0, 1), np.int16), RATE) if tune is None else tune
        longest = round((max(begins_s) + DURATION_MAX_S) * sound.rate)
        mixed = with_tones(sound._replace(samples=sound.samples[:longest]), tones)
        try:
            number, name = tempfile.mkstemp(".wav", "beatrix-")
            with os.fdopen(number, "wb") as file, wave.open(file, "wb") as out:
                out.setparams((1, 2, sound.rate, 0, "NONE", ""))
                out.writeframes(mixed.tobytes())
        except OSError:  # a full disk ends no dance
            self._fail()
            return None
        return Path(name)

    def play(self, track: Path) -> None:
        """Play a track from its beginning, instead of the present one; without a player it is only reported."""
        self.silence()
        command, null = player(sys.platform), subprocess.DEVNULL
        with self._lock:
            if not self._on:
                return
            if self._progress.ready or not self._progress.file:
                self._progress = replace(self._progress, trouble=None)
            try:
                words = (*command, str(track))
                self._player = subprocess.Popen(words, stdin=null, stdout=null, stderr=null)
            except OSError:  # there is no such program
                self._fail()

    def silence(self) -> None:
        """End the player at once."""
        with self._lock:
            child, self._player = self._player, None
            if child is None:
                return
            child.kill()
            with suppress(subprocess.TimeoutExpired):
                child.wait(END_S)

    def _fail(self) -> None:
        self._progress = replace(self._progress, trouble=Trouble("trouble.no_player"))


def player(platform: str) -> tuple[str, ...]:
    """Return the command that plays a WAV file on a platform."""
    if platform == "win32":
        return sys.executable, "-I", "-c", WINDOWS
    return next((words for words in PLAYERS if shutil.which(words[0])), PLAYERS[0])


def decoded(file: Path) -> Wav:
    """Return the sound of a file, with one channel.

    Raises:
        OSError: it cannot be read.
        ImportError: it is no WAV file, and the library for films is not installed.
        ValueError: it is no sound, or too long.
    """
    import numpy as np  # noqa: PLC0415

    from beatrix_zenoh import wav  # noqa: PLC0415

    try:
        sound = wav.read(file, LONGEST_S)
    except ValueError:
        if file.suffix.lower() == ".wav":
            raise
        sound = decoded_by_av(file)
    channels = sound.samples.shape[1]
    mono = sound.samples.sum(axis=1, dtype=np.int32, keepdims=True) // channels
    return sound._replace(samples=mono.astype(np.int16))


def decoded_by_av(file: Path) -> Wav:
    """Return the sound of an MP3 or other file, as `decoded` does."""
    import av  # noqa: PLC0415
    import numpy as np  # noqa: PLC0415

    from beatrix_zenoh.wav import Wav  # noqa: PLC0415

    parts: list[Samples] = []
    resampler = av.AudioResampler("s16", "mono", RATE)
    try:
        with av.open(str(file)) as container:
            for frame in container.decode(audio=0):
                parts.extend(part.to_ndarray()[0] for part in resampler.resample(frame))
                if (frame.time or 0.0) > LONGEST_S:
                    raise ValueError("too long")
    except (av.FFmpegError, IndexError) as error:
        raise ValueError(str(error)) from error
    return Wav(np.concatenate(parts)[:, None], RATE)


def with_tones(sound: Wav, tones: Sequence[tuple[float, int]]) -> Samples:
    """Return mono samples with tones: when each one begins (s), and its number from 1."""
    import numpy as np  # noqa: PLC0415

    rate, length = sound.rate, round(TONE_S * sound.rate)
    ends = [round(at_s * rate) + length for at_s, _ in tones]
    mixed = np.zeros(max(len(sound.samples), *ends, 0), np.int16)
    mixed[: len(sound.samples)] = sound.samples[:, 0]
    t_s = np.arange(length) / rate
    envelope = np.minimum(1.0, t_s / 0.005) * np.exp(-t_s / 0.12) * 9000
    for end, (_, note) in zip(ends, tones, strict=True):
        turns = 2 * np.pi * FREQUENCIES[note - 1] * t_s
        tone = envelope * (np.sin(turns) + 0.3 * np.sin(2 * turns) + 0.1 * np.sin(3 * turns))
        mixed[end - length : end] = np.clip(mixed[end - length : end] + tone, -32768, 32767).astype(np.int16)
    return mixed
