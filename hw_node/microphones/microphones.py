"""The microphones of the robot: the values of `--microphones`, and the component that publishes their sound."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Final

from beatrix_zenoh import threads
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage, quoted
from beatrix_zenoh.node import MicrophonesPublisher, Node, SoundBlock
from beatrix_zenoh.node.microphones import TITLE
from hw_node.microphones.stand_ins import SoundFile, Tone
from hw_node.sensor import SILENT_S, Sensor, SensorSource

TONE, FILE, OFF = "tone", "file:", "off"
SILENCE: Final = f"The microphones are plugged in but have delivered no sound for {SILENT_S:g} s. Unplug them, and plug them in again."
SoundSource = SensorSource[SoundBlock]


class MicrophoneSensor(Sensor[SoundBlock]):
    """The two microphones of the robot."""

    def __init__(self, node: Node, source: SoundSource) -> None:
        wake = threading.Event()
        key = keys.microphones(node.name, node.side)
        publisher = MicrophonesPublisher(key, node.events, source.name, wake.set, announce=True)
        super().__init__(TITLE, source, publisher, wake, SILENCE)

    def start_thread(self) -> threading.Thread:
        """Start the thread."""
        return threads.start(self.run, "microphones")


def choose(word: str) -> SoundSource | None:
    """Create the source that `--microphones` names; None for `off` and an empty text.

    No device is opened; a file is read once, to refuse a damaged one.

    Raises:
        WrongUsage: BAD_VALUE, with the mistake and the allowed values.
    """
    if word in ("", OFF):
        return None
    if word == TONE:
        return Tone()
    if word.startswith(FILE):
        source = SoundFile(Path(word.removeprefix(FILE)))
        if trouble := source.trouble():
            raise wrong(word, trouble)
        try:
            source.open()
        except NoAnswer as error:
            raise wrong(word, error.message) from error
        source.close()
        return source
    from hw_node.microphones import device  # noqa: PLC0415 - an extra

    try:
        return device.DeviceMicrophones(word, device.library())
    except WrongUsage as error:
        text = f"{error.message} Without it, `{TONE}` is a test tone, `{FILE}PATH` a WAV file, and `{OFF}` means none."
        raise wrong(word, text) from error


def wrong(word: str, text: str) -> WrongUsage:
    """Return the error for a value of --microphones."""
    return WrongUsage(Reason.BAD_VALUE, f"--microphones {quoted(word)}: {text}")
