"""The header: robot, page of the class, state of each robot, recording, and the menu of themes and languages."""

from __future__ import annotations

from PyQt5.QtCore import QPoint, QSignalBlocker, Qt, pyqtSignal
from PyQt5.QtWidgets import (
    QAction,
    QActionGroup,
    QLayout,
    QMenu,
    QSizePolicy,
    QWidget,
)

from beatrix_zenoh.contract.names import SIDES
from gui.console.state.actions import ChooseRobot, LookForPorts
from gui.console.state.intents import Choose, EmergencyStop, Intent, Theme, WindowPage
from gui.console.state.missions import OpenGuide
from gui.console.state.views import ButtonView, PillView, RecordView, ShowView, View
from gui.console.texts import LANGUAGES, Texts
from gui.window.theme import CONDITION_ROLES
from gui.window.widgets.controls import (
    NO_MARGINS,
    SEPARATOR,
    ChoiceCheck,
    ElidedLabel,
    IntentButton,
    NameBox,
    Panel,
    in_column,
    in_row,
    label,
    named,
    plain_button,
    set_role,
    show_each,
)

MENU_PX = 230


class RobotMenu(Panel):
    """Buttons below the pill; one with a question shows it here and stays open for the second press."""

    def __init__(self, parent: QWidget, robot: str) -> None:
        """Create it closed; `robot` is Simulation or Hardware, which screen readers say with each button."""
        super().__init__("panel", parent)
        self._robot = robot
        self.setWindowFlags(Qt.WindowType.Popup)
        self.buttons: list[IntentButton] = []
        self._list = in_column(gap=8)
        self.question = label(wrap=True)
        self.question.setFixedWidth(MENU_PX)
        self.question.hide()
        whole = in_column(self._list, self.question, gap=8, margins=(8, 8, 8, 8), inside=self)
        whole.setSizeConstraint(QLayout.SizeConstraint.SetFixedSize)  # as the buttons and the question need

    def show_view(self, views: tuple[ButtonView, ...]) -> None:
        """Show a button for each command."""
        show_each(views, self.buttons, self._button, self._robot)

    def _button(self, view: ButtonView) -> IntentButton:
        button = IntentButton()
        button.setMinimumWidth(MENU_PX)
        button.setAutoDefault(True)  # Enter presses it; Space is STOP
        if isinstance(view.intent, EmergencyStop):
            button.setObjectName("emergency")
        button.intent.connect(self._choose)
        button.asking.connect(self._ask)
        self._list.addWidget(button)
        return button

    def open(self, below: QWidget) -> None:
        """Open below a button, at its right edge."""
        self.adjustSize()
        corner = below.mapToGlobal(QPoint(below.width() - self.width(), below.height() + 2))
        self.move(max(0, corner.x()), corner.y())
        self.show()
        if self.buttons:
            self.buttons[0].setFocus()

    def _choose(self, intent: Intent) -> None:
        self.close()
        self.intent.emit(intent)

    def _ask(self, question: str) -> None:
        self.question.setText(f"▲ {question}")
        self.question.setVisible(bool(question))


MORE_PX = 24
ROBOTS_SHOWN = 16
"""Robots in the open list; further ones are reached by its scroll bar, or by typing the first letters of a name."""


class RecordButtons(Panel):
    """The buttons that open the last recording, and begin and end one."""

    def __init__(self) -> None:
        super().__init__()
        self.open, self.toggle = self.button(), self.button()
        for button in (self.open, self.toggle):
            button.setObjectName("record")  # wide enough for a duration, so that it stays under the mouse
        in_row(self.open, self.toggle, gap=4, margins=NO_MARGINS, inside=self)

    def show_view(self, view: RecordView) -> None:
        """Show the buttons."""
        self.open.show_view(view.open)
        self.toggle.show_view(view.toggle)
        self.toggle.setText(f"■ {view.text}" if view.text else view.toggle.text)
        set_role(self.toggle, "recording", "yes" if view.text else "")


class ShowButtons(Panel):
    """Photo, film with its clock, and the button that opens the last of them."""

    def __init__(self) -> None:
        super().__init__()
        self.photo, self.film = self.button(), RecordButtons()
        self.reports(self.film.intent)
        in_row(self.photo, self.film, gap=4, margins=NO_MARGINS, inside=self)

    def show_view(self, view: ShowView) -> None:
        """Show the buttons."""
        self.photo.show_view(view.photo)
        self.film.show_view(view.film)


class Pill(Panel):
    """State of one robot, with the buttons for its next step and lease."""

    def __init__(self, side: str, texts: Texts) -> None:
        super().__init__("pill")
        self._shown: tuple[PillView, ButtonView | None] | None = None
        self.setProperty("side", side)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.title, self.state = label(role=side), ElidedLabel()
        self.notes, self.reason = ElidedLabel("dim", 0), ElidedLabel("dim", 0)
        """notes and round trip; cause and warnings"""
        self.reason.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.next_step, self.lease = self.button(), self.button()
        self.next_step.setProperty("next_step", True)  # noqa: FBT003
        name = f"{texts(f'label.{side}')}: {texts('label.robot_menu')}"
        self.menu = RobotMenu(self, texts(f"label.{side}"))
        self.more = plain_button("⋮", texts("tip.robot_menu"), name)
        self.more.setProperty("jog", True)  # noqa: FBT003
        self.more.setFixedWidth(MORE_PX)
        self.more.clicked.connect(lambda: self.menu.open(self.more))
        self.reports(self.menu.intent)
        words = in_column(in_row(self.title, (self.notes, 1), gap=8), self.state, gap=0)
        parts = words, (self.reason, 1), self.next_step, self.lease, self.more
        in_row(*parts, margins=(6, 2, 6, 2), inside=self)
        self.next_step.hide()
        self.lease.hide()

    def show_state(self, view: PillView, emergency: ButtonView | None) -> None:
        """Show the robot's state; the menu ends with the button of EMERGENCY_STOP, if it is given."""
        if (view, emergency) == self._shown:
            return
        self._shown = view, emergency
        self.menu.show_view(view.menu if emergency is None else (*view.menu, emergency))
        self.title.setText(view.title)
        set_role(self.state, "role", CONDITION_ROLES[view.condition])
        self.state.setText(f"{view.symbol} {view.text}")
        self.notes.setText(SEPARATOR.join(filter(None, (*view.notes, view.latency))))
        self.reason.setText(" ".join(line for line in (view.reason, *view.warnings) if line))
        lines = [view.reason, *view.warnings, SEPARATOR.join(view.notes), view.details]
        named(self, f"{view.title}: {view.text}", "\n".join(line for line in lines if line))
        buttons = [(self.next_step, view.next_step), (self.lease, view.lease)]
        # The hidden one first, so that the window never needs the width of both.
        for button, shown in sorted(buttons, key=lambda pair: pair[1] is not None):
            button.show_view(shown, view.title)


class Header(Panel):
    """One line above all panels."""

    keys_asked = pyqtSignal()
    """the user wants to see or hide the sheet of keys"""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._robots: tuple[str, ...] = ()
        self._tip = texts("tip.robot")
        self.robots = named(NameBox(), texts("label.robot"), self._tip)
        self.robots.setMaxVisibleItems(ROBOTS_SHOWN)
        self.robots.textActivated.connect(lambda name: self.intent.emit(ChooseRobot(name)))
        self.pills = {side: Pill(side, texts) for side in SIDES}
        self.page, self.record = self.button(), RecordButtons()
        self.page.hide()
        self.simple = ChoiceCheck(texts, "simple")
        self.menu_button = plain_button("≡", texts("tip.menu"), texts("label.menu"))
        self.menu, self.choices = self._menu(texts)
        self.menu_button.clicked.connect(self._open_menu)
        self.reports(self.simple.intent, self.record.intent, *(pill.intent for pill in self.pills.values()))
        sim, hw = ((pill, 1) for pill in self.pills.values())
        parts = self.robots, self.page, sim, hw, in_column(self.record, self.simple, gap=0), self.menu_button
        in_row(*parts, gap=4, margins=NO_MARGINS, inside=self)

    def _menu(self, texts: Texts) -> tuple[QMenu, dict[str, QAction]]:
        menu, choices = QMenu(self), dict[str, QAction]()
        for choice, codes in (("theme", [*Theme]), ("language", [*LANGUAGES])):
            menu.addSeparator()
            heading = self._entry(menu, texts(f"label.{choice}"), None)
            heading.setEnabled(False)  # Fusion does not draw the text of sections
            group = QActionGroup(menu)
            for code in codes:
                entry = self._entry(menu, texts(f"label.{choice}_{code}"), Choose(choice, code))
                entry.setCheckable(True)
                choices[str(code)] = group.addAction(entry)
        menu.addSeparator()
        choices["sounds"] = sounds = self._entry(menu, texts("label.sounds"), None)
        sounds.setCheckable(True)
        sounds.triggered.connect(lambda on: self.intent.emit(Choose("sounds", value=on)))
        self._entry(menu, texts("strip.lessons"), OpenGuide())
        self._entry(menu, texts("label.connect"), LookForPorts())
        self._entry(menu, f"{texts('label.keys')}\tF1", None).triggered.connect(self.keys_asked)
        return menu, choices

    def _entry(self, menu: QMenu, text: str, intent: Intent | None) -> QAction:
        """Add an entry that reports an intent, if it is given."""
        entry = QAction(text, menu)
        if intent is not None:
            entry.triggered.connect(lambda: self.intent.emit(intent))
        menu.addAction(entry)
        return entry

    def _open_menu(self) -> None:
        """Open the menu without blocking the window."""
        corner = self.menu_button.mapToGlobal(QPoint(self.menu_button.width(), self.menu_button.height()))
        self.menu.popup(corner - QPoint(self.menu.sizeHint().width(), 0))

    def show_view(self, view: View) -> None:
        """Show robots, states and choices."""
        robots = tuple(dict.fromkeys((*view.robots, view.robot)))
        with QSignalBlocker(self.robots):
            if robots != self._robots:
                self._robots = robots
                self.robots.clear()
                self.robots.addItems(list(robots))
            self.robots.setCurrentText(view.robot)
        self.robots.setToolTip(f"{view.robot}\n{self._tip}")
        emergency = view.emergency if view.choices.page is WindowPage.ROBOT else None
        for pill in view.pills:
            self.pills[pill.side].show_state(pill, emergency)
        self.page.show_view(None if view.class_page is None else view.class_page.toggle)
        self.record.show_view(view.record)
        for chosen in (view.choices.theme.value, view.choices.language):
            self.choices[chosen].setChecked(True)
        self.choices["sounds"].setChecked(view.choices.sounds)
