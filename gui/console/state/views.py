"""The content of widgets: texts in the user's language, numbers ready to draw, and the intents of buttons."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from beatrix_zenoh.client import Place
from gui.console.state.intents import HeadOrientation, Intent
from gui.console.state.lessons import LessonsView
from gui.console.state.saved import Choices
from gui.console.state.world import Person
from gui.console.texts import Texts


class Condition(StrEnum):
    """State of a robot in one word; each has a symbol and a colour."""

    ABSENT = "absent"
    SILENT = "silent"
    """the robot has a liveliness token, but no positions arrive"""
    DISABLED = "disabled"
    NOT_CALIBRATED = "not calibrated"
    READY = "ready"
    MOVING = "moving"
    DRIVEN = "driven"
    """another seat is its holder"""
    FROZEN = "frozen"
    """the teacher has frozen it"""
    FAULT = "fault"


@dataclass(frozen=True)
class ButtonView:
    """A button: its text and intent."""

    text: str
    tooltip: str
    """what the button does, with its key; or why the button is disabled"""
    intent: Intent
    enabled: bool = True
    question: str = ""
    """shown at the first press; the second press reports the intent; empty: one press is enough"""


def button(
    texts: Texts, key: str, intent: Intent, off: str = "", *, question: str = "", **slots: str | float
) -> ButtonView:
    """Return the button of the text `key`, with the tooltip `key_tip`; disabled for the reason `off`, if that is a key."""
    tooltip = texts(off or f"{key}_tip", **slots)
    return ButtonView(texts(key, **slots), tooltip, intent, enabled=not off, question=question)


@dataclass(frozen=True)
class PillView:
    """State of one robot."""

    side: str
    title: str
    """Simulation or Hardware"""
    condition: Condition
    symbol: str
    text: str
    """the condition in a word or two, for example `driven by ana`"""
    reason: str
    """the cause and what to do, in a sentence; empty if the robot is ready"""
    next_step: ButtonView | None
    latency: str
    """round trip of a query, for example `2 ms`; empty: unknown"""
    notes: tuple[str, ...]
    """microphones that are on, holder, waiting seats and speed limit, unless `text` contains them; the most important first"""
    lease: ButtonView | None
    """takes the robot, waits for it or gives it back; None: there is a next step, or the robot does not answer"""
    menu: tuple[ButtonView, ...] = ()
    """commands that are rarely needed"""
    warnings: tuple[str, ...] = ()
    details: str = ""
    """board, cameras and waiting seats, for the tooltip"""


@dataclass(frozen=True)
class BannerView:
    """The banner over the whole width: the action that is needed first, with its buttons."""

    text: str
    buttons: tuple[ButtonView, ...] = ()


@dataclass(frozen=True)
class StripView:
    """The strip below the header: the present step, mission or lesson."""

    text: str
    progress: str
    """a dot for each step, mission or lesson, full if it is done"""
    count: str
    """the same in words"""
    buttons: tuple[ButtonView, ...]
    good: bool | None = None
    """True: something was just done, or this lesson has passed; False: not yet"""
    lessons: tuple[ButtonView, ...] = ()
    """the menu of all lessons"""
    page: str = ""
    """text of a sheet (Markdown); empty: none"""
    picture: str = ""
    """file of a picture (SVG) in a sheet; empty: none"""


@dataclass(frozen=True)
class RefusalView:
    """A refusal, shown over the picture of the head."""

    text: str
    alternative: ButtonView | None = None


@dataclass(frozen=True)
class DragView:
    """What dragging the head does, and where it may rest."""

    live: bool
    """whether the simulation follows while the user drags"""
    border: tuple[float, ...]
    """how far the head may lean in each direction (deg): see `beatrix_zenoh.motion.limits.region.border`"""
    refused: HeadOrientation | None
    """the target that was refused; None: none, or its refusal is hidden"""
    reason: str
    """why, in a word or two; empty: none was refused"""


@dataclass(frozen=True)
class HeadView:
    """The head pad, and the head in three dimensions."""

    target: HeadOrientation
    sim: HeadOrientation | None
    hw: HeadOrientation | None
    solid: str
    """`sim` or `hw`: the robot that is drawn solid, and the other one as a ghost"""
    shown: HeadOrientation | None
    """its newest head, even an old one; None: it is not online"""
    silent: bool
    """whether `shown` is old or None"""
    asleep: bool
    """whether the motors of that robot are off"""
    tilt_max: float
    """limit (deg)"""
    yaw_max: float
    """limit in both directions (deg)"""
    path: tuple[HeadOrientation, ...]
    """the previewed path; empty: none"""
    facing: bool
    """whether the pad shows the head from the front, so that its left is at the right"""
    drag: DragView
    send: ButtonView
    unsent: bool
    """whether the target is elsewhere than a robot to send it to"""
    refusal: RefusalView | None = None

    def side(self, side: str) -> HeadOrientation | None:
        """Return the head of `sim` or `hw`."""
        return self.sim if side == "sim" else self.hw


@dataclass(frozen=True)
class ArmRowView:
    """One row of the arms: one arm, or all."""

    arm: str
    title: str
    axis: str
    """x, y or z; empty for all"""
    sim: str
    """angle as text, for example `12.0°`; `–` if unknown"""
    hw: str
    difference: str
    """hardware minus simulation; empty: unknown"""
    minus: ButtonView
    plus: ButtonView


@dataclass(frozen=True)
class ArmsView:
    """The arms, and the mode of + and -."""

    rows: tuple[ArmRowView, ...]
    """short, middle, long, all"""
    increment_max: float
    """deg"""
    speed_max: float
    """deg/s"""
    refusal: RefusalView | None = None


@dataclass(frozen=True)
class SendingView:
    """Destinations of motions, and the present motion."""

    lead_matters: bool
    """whether Simulation and Hardware are both checked, so that the lead has an effect"""
    title: str
    """state of the motion in a few words"""
    text: str
    """the verdict, or what to do"""
    countdown: str
    """for example `hardware follows in 1.4 s`; empty: nothing waits"""
    progress: float | None
    """elapsed share of the lead, 0 to 1; None: nothing waits"""
    send_now: ButtonView
    change: ButtonView
    abort: ButtonView


@dataclass(frozen=True)
class HistoryRowView:
    """One request, of this window or of another seat."""

    row: int
    """number of the row; -1: a request of another seat, which cannot be repeated"""
    time: str
    who: str
    what: str
    result: str
    symbol: str
    good: bool | None
    """whether the request succeeded; None: it has not ended"""
    on_purpose: bool = False
    """whether it did not succeed because the user has replaced or aborted it, which is no error"""


@dataclass(frozen=True)
class CodeView:
    """The program in the code panel, and its newest run."""

    text: str
    opens: int
    """how often the user has opened a program"""
    title: str
    file: Path | None
    """None: it is the program of the presses"""
    folder: Path
    """the folder of the user's programs"""
    run: ButtonView
    """or end"""
    message: str
    failed: bool
    output: tuple[str, ...]
    line: int
    """the line at which it has failed; 0: none"""


@dataclass(frozen=True)
class CommandsView:
    """The commands, by name."""

    buttons: dict[str, ButtonView]
    refusal: RefusalView | None = None


@dataclass(frozen=True)
class OwnGestureView:
    """A gesture of the user."""

    name: str
    emoji: str
    play: ButtonView
    menu: tuple[ButtonView, ...]
    """changes; the one with `SaveGesture` asks for name and emoji first"""


@dataclass(frozen=True)
class GesturesView:
    """Gestures, and the programs that follow a face and turn to a sound."""

    gestures: tuple[tuple[str, ButtonView], ...]
    """name and button of each shipped gesture"""
    own: tuple[OwnGestureView, ...]
    fetch: ButtonView | None
    """None: there is no class"""
    follow: ButtonView
    turn: ButtonView
    running: Path | None
    """the program that runs, perhaps FOLLOW or TURN"""
    refusal: RefusalView | None = None


@dataclass(frozen=True)
class BlocksView:
    """The program of blocks of a page."""

    run: ButtonView
    """its intent without the program, which the page adds"""
    end: ButtonView
    runs: bool
    block: str
    """id of the present block; empty: none"""
    text: str
    """result of the last program, or why it was refused; empty: there was none"""
    at: str
    """id of the block that `text` is about; empty: the whole program"""


@dataclass(frozen=True)
class CardView:
    """One pose of the sequence."""

    name: str
    head: HeadOrientation | None
    """None: no head can have this pose"""
    duration_s: float
    duration: str
    """the duration as text, the shortest one if it is too short, or a word if the limits do not allow the pose"""
    problem: str
    """why the pose cannot be reached, or not in its duration; empty: it can"""
    beats: float = 0.0
    """duration in beats of the music; 0: there is no beat"""
    note: int = 0
    """as of `SavedPose`"""


@dataclass(frozen=True)
class MusicView:
    """The music beside the sequence, and the tones of its poses."""

    text: str
    """of the button"""
    title: str
    """a sentence about the music: its tempo, or why it cannot be used"""
    snap: ButtonView
    remove: ButtonView


@dataclass(frozen=True)
class SequenceView:
    """The sequence editor."""

    cards: tuple[CardView, ...]
    add: ButtonView
    """the button's intent has no name: the page adds the text of its field"""
    undo: ButtonView
    play: ButtonView
    hardware: ButtonView
    gesture: ButtonView
    """the button's intent has no name and no emoji: the widget of the gestures asks for them"""
    played: int = -1
    """number of the card that is being played, from 0; -1: none"""
    facing: bool = True
    """whether the cards show the heads as a viewer in front of them sees them, or as in a mirror"""


@dataclass(frozen=True)
class EyeView:
    """One picture: its camera, and the text in its place."""

    side: str
    eye: str
    """`left` or `right`"""
    title: str
    watched: bool
    """whether the window subscribes to the picture"""
    text: str
    """the reason why there is no picture; empty: there is one"""


@dataclass(frozen=True)
class RoomView:
    """The room beside the head: the simulated person, and what the left eye sees."""

    person: Person | None
    """None: there is no simulation, or it has not answered yet"""
    yaw: float | None
    """of the head that sees or hears (deg); None: unknown"""
    speak: ButtonView
    """lets the person speak, or be silent"""
    eye: EyeView


@dataclass(frozen=True)
class LevelView:
    """What one robot hears: a bar for each ear."""

    side: str
    title: str
    left: float
    """length of the bar, 0 to 1"""
    right: float
    text: str
    """the levels in dB, or the reason why there are none"""


@dataclass(frozen=True)
class SoundView:
    """The box of the microphones, and the levels of simulation and hardware."""

    on: bool
    """whether the user wants to see the levels; then the microphones are on"""
    levels: tuple[LevelView, ...]


@dataclass(frozen=True)
class RecordView:
    """The Record button."""

    toggle: ButtonView
    text: str = ""
    """duration, for example `0:12`; empty: no recording runs"""
    open: ButtonView | None = None


@dataclass(frozen=True)
class ShowView:
    """The buttons that show the head to others."""

    photo: ButtonView
    film: RecordView
    """opens photos, too"""


@dataclass(frozen=True)
class ClassRowView:
    """One robot of the class."""

    place: Place
    """name and side"""
    cells: tuple[str, ...]
    """robot, side, state, holder, time left of its turn, waiting seats, positions per second, age of the last positions, remarks"""
    condition: Condition
    details: str
    """text of the tooltip"""
    freeze: ButtonView
    """or unfreeze"""
    take: ButtonView
    """or give back"""
    show: ButtonView
    """leave this page and show this robot"""


@dataclass(frozen=True)
class SeatView:
    """One seat of the class."""

    text: str
    """the seat, and whether it is muted"""
    mute: ButtonView
    """or unmute"""


@dataclass(frozen=True)
class ClassView:
    """The page of the class: all robots and seats at the router."""

    summary: str
    """number of robots, and the connected seats"""
    rows: tuple[ClassRowView, ...]
    empty: str
    """what to do if there is no row; else empty"""
    freeze_all: ButtonView
    unfreeze_all: ButtonView
    limit: ButtonView
    """the button's intent has no speed: the widget adds the text of the field"""
    limit_now: str
    """the present limit"""
    seats: tuple[SeatView, ...]
    """connected and muted seats, except the teacher, by name"""
    result: str
    """the outcome of the last request of this page; empty: none was sent"""
    good: bool | None
    """whether that request was carried out everywhere; None: it has not ended"""
    toggle: ButtonView
    """switches between this page and the robot"""
    lessons: LessonsView


@dataclass(frozen=True)
class RouterView:
    """The router and the account of the window."""

    address: str
    text: str
    """whether the router answers, what goes on, or why the last choice is not used"""
    details: str
    """the English sentence of the library about that; empty: none"""
    good: bool | None
    """whether the router answers and the last choice is used; None: not known yet"""
    use: ButtonView
    """the button's intent has no address: the widget adds the text of the field"""
    account: str
    join: ButtonView
    """the button's intent has no file: the widget asks for it"""


@dataclass(frozen=True)
class ConnectView:
    """The sheet that connects: router, account, and the list of ports of the hardware."""

    router: RouterView
    text: str
    """what to do, what goes on, or why it has failed"""
    details: str
    """the output of the program that has failed, in English; empty: none has"""
    ports: tuple[ButtonView, ...]
    """boards, other ports, the virtual robot; empty if hardware is online"""
    again: ButtonView
    close: ButtonView


@dataclass(frozen=True)
class View:
    """Everything that the window shows at one moment, except pictures and plots."""

    title: str
    banner: BannerView | None
    guide: StripView | None
    """a step, mission or lesson; None: none, or the banner is more important"""
    robots: tuple[str, ...]
    robot: str
    pills: tuple[PillView, ...]
    """simulation, hardware"""
    head: HeadView
    arms: ArmsView
    sending: SendingView
    commands: CommandsView
    gestures: GesturesView
    blocks: BlocksView
    sequence: SequenceView
    music: MusicView
    eyes: tuple[EyeView, ...]
    sound: SoundView
    history: tuple[HistoryRowView, ...]
    """newest first"""
    code: CodeView
    record: RecordView
    show: ShowView
    last: str
    """the last request with its outcome"""
    last_detail: str
    """raw output of a failed program that the line is about, in English; empty: none"""
    stop: ButtonView
    emergency: ButtonView
    choices: Choices
    room: RoomView | None
    """None: hidden"""
    class_page: ClassView | None
    """None: this window is not the teacher's"""
    connect: ConnectView | None = None
    """None: the sheet is hidden"""
