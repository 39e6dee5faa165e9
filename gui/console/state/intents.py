"""Intents of the user, as widgets report them; angles in degrees, speeds in deg/s, times in s.

A pose is named by its name, which is unique in the sequence.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated

import msgspec
from msgspec import Meta

from beatrix_zenoh.contract._generated.messages import Command

ALL_ARMS = "all"

Angle = Annotated[float, Meta(ge=-360, le=360)]
"""deg"""
PoseName = Annotated[str, Meta(max_length=64)]
Side = Annotated[str, Meta(pattern="^(sim|hw)$")]
"""These limits hold for the messages of pages, which msgspec decodes."""


@dataclass(frozen=True)
class HeadOrientation:
    """Orientation of a head (deg); left, nose down and right ear down are positive."""

    yaw: float
    pitch: float
    roll: float

    @property
    def tenths(self) -> tuple[float, float, float]:
        """Yaw, pitch and roll to a tenth of a degree, less than a pixel."""
        return round(self.yaw, 1) + 0.0, round(self.pitch, 1) + 0.0, round(self.roll, 1) + 0.0

    def away(self, other: HeadOrientation) -> float:
        """Return the largest difference of an angle (deg)."""
        return max(abs(self.yaw - other.yaw), abs(self.pitch - other.pitch), abs(self.roll - other.roll))


class Tab(StrEnum):
    """A tab of the middle column."""

    HEADS = "heads"
    EYES = "eyes"
    PLOTS = "plots"


class WindowPage(StrEnum):
    """A page of the window."""

    ROBOT = "robot"
    """simulation and hardware of one name"""
    CLASS = "class"
    """all robots and seats at the router; only in the teacher's window"""


class Theme(StrEnum):
    """Colours and sizes."""

    DARK = "dark"
    LIGHT = "light"
    PROJECTOR = "projector"


class Intent(msgspec.Struct, frozen=True, tag=True, tag_field="do", forbid_unknown_fields=True):
    """Base class of all intents; in JSON the field `do` is the name of the class."""


class Stop(Intent, frozen=True):
    """Stop the robots of the shown page at once, regardless of the checked boxes."""


class EmergencyStop(Intent, frozen=True):
    """Switch the motors of the robots of the shown page off at once; their heads fall."""


class Jog(Intent, frozen=True):
    """+ or - of an arm: in relative mode turn it by the increment, in absolute mode send it to + or - the increment."""

    arm: str
    """`short`, `middle`, `long` or `all`"""
    sign: int
    """+1 or -1"""


class AimHead(Intent, frozen=True):
    """Move the target of the head pad; nothing is sent."""

    yaw: Angle
    pitch: Angle
    roll: Angle


class SendHead(Intent, frozen=True):
    """Send the target of the head pad."""


class GrabHead(Intent, frozen=True):
    """Begin to drag the head."""


class LiveHead(Intent, frozen=True):
    """While the user drags: let the simulation follow the target, if that was chosen."""


class ReleaseHead(Intent, frozen=True):
    """End a drag of the head; the target is sent if that was chosen."""


class RunCommand(Intent, frozen=True):
    """Send a command to the checked robots, or to one robot as its next step."""

    command: Command
    value: bool = True
    """for ENABLE: on or off"""
    side: Annotated[str, Meta(pattern="^(sim|hw|)$")] = ""
    """empty: the checked robots"""


class DismissNotice(Intent, frozen=True):
    """Hide the sentence about a lease that this seat gained or lost."""


class TogglePage(Intent, frozen=True):
    """Switch between the page of the class and the robot; only in the teacher's window."""


class LimitClass(Intent, frozen=True):
    """Limit the speed of all robots of the class, as the teacher."""

    text: str
    """deg/s as the user has typed it; empty: no limit"""


class Change(Intent, frozen=True):
    """End the motion before the hardware moves, and restore its target on the pad."""


class TakeAlternative(Intent, frozen=True):
    """Send the alternative or next step of the shown refusal."""


class DismissRefusal(Intent, frozen=True):
    """Hide the shown refusal."""


class Undo(Intent, frozen=True):
    """Turn the arms back to their angles before the last motion."""


class Repeat(Intent, frozen=True):
    """Send a row of the history again."""

    row: int
    """number of the row"""


class Choose(Intent, frozen=True):
    """Change a choice of the user."""

    name: str
    """a field of `saved.Choices`"""
    value: bool | float | str


class AddPose(Intent, frozen=True):
    """Add the target of the pad, or the present pose, at the end."""

    name: PoseName = ""
    """empty: `pose-1`, or the next free number"""


class DeletePose(Intent, frozen=True):
    """Delete a pose."""

    name: PoseName


class MovePose(Intent, frozen=True):
    """Move a pose to another place of the sequence."""

    name: str
    to: int
    """number of the place, from 0, counted without the pose"""


class DuplicatePose(Intent, frozen=True):
    """Insert a copy after a pose: a pause of that duration, until one of them is changed."""

    name: str


class SetDuration(Intent, frozen=True):
    """Choose the time in which a pose is reached from the previous one."""

    name: PoseName
    seconds: float


class RenamePose(Intent, frozen=True):
    """Give a pose another name."""

    name: str
    new: str


class UndoSequence(Intent, frozen=True):
    """Undo the last change of the poses, for example a deletion."""


class PlaySequence(Intent, frozen=True):
    """Play the sequence on one robot; on the hardware only after the simulation has played it."""

    side: Side


class RunBlocks(Intent, frozen=True):
    """Run a program of blocks with the checked robots."""

    program: str
    """what Blockly has saved, as JSON"""


class SaveGesture(Intent, frozen=True):
    """Save the sequence as a gesture, which replaces one of the same name; or rename a gesture."""

    name: str
    emoji: str
    old: str = ""
    """the gesture to rename; empty: the sequence is saved"""
