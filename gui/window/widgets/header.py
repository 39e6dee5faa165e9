"""The header: robot, page of the class, state of each robot, recording, and the menu of themes and languages."""

from __future__ import annotations

from PyQt5.QtCore import QPoint, QSignalBlocker, QSize, Qt, pyqtSignal
from PyQt5.QtGui import QHideEvent, QKeyEvent
from PyQt5.QtWidgets import (
    QAbstractButton,
    QAction,
    QActionGroup,
    QComboBox,
    QHBoxLayout,
    QMenu,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from beatrix_zenoh.contract.names import SIDES
from gui.console.state.actions import ChooseRobot, LookForPorts
from gui.console.state.intents import Choose, EmergencyStop, Intent, Theme, WindowPage
from gui.console.state.views import ButtonView, PillView, RecordView, View
from gui.console.texts import LANGUAGES, Texts
from gui.window.keys import SEND_KEYS
from gui.window.theme import CONDITION_ROLES
from gui.window.widgets.controls import (
    NO_MARGINS,
    SEPARATOR,
    ElidedLabel,
    IntentButton,
    Panel,
    filled,
    label,
    plain_button,
    set_role,
    set_text,
    show_each,
    spaced,
)

MENU_PX = 230


class RobotMenu(Panel):
    """Buttons below the pill; one with a question shows it here and stays open for the second press."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__("panel", parent)
        self.setWindowFlags(Qt.WindowType.Popup)
        self._views: tuple[ButtonView, ...] = ()
        self.setFixedWidth(MENU_PX)
        self.buttons: list[IntentButton] = []
        self.question = label(wrap=True)
        self.question.hide()
        self._column = spaced(QVBoxLayout(self), 8, (8, 8, 8, 8))
        self._column.addWidget(self.question)

    def show_view(self, views: tuple[ButtonView, ...]) -> None:
        """Show a button for each command."""
        if views == self._views:
            return
        self._views = views
        show_each(views, self.buttons, self._button)
        self._fit()

    def _button(self, view: ButtonView) -> IntentButton:
        button = IntentButton()
        if isinstance(view.intent, EmergencyStop):
            button.setObjectName("emergency")
        button.intent.connect(self._choose)
        button.asking.connect(self._ask)
        self._column.insertWidget(len(self.buttons), button)
        return button

    def open(self, below: QWidget) -> None:
        """Open below a button, at its right edge."""
        self._fit()
        corner = below.mapToGlobal(QPoint(below.width() - self.width(), below.height() + 2))
        self.move(max(0, corner.x()), corner.y())
        self.show()
        if self.buttons:
            self.buttons[0].setFocus()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802
        """Press the focused button with Enter, as in the window; Space is STOP."""
        focus = self.focusWidget()
        if event.key() in SEND_KEYS and isinstance(focus, QAbstractButton):
            focus.click()
        else:
            super().keyPressEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802
        super().hideEvent(event)
        for button in self.buttons:
            button.disarm()

    def _choose(self, intent: Intent) -> None:
        self.close()
        self.intent.emit(intent)

    def _ask(self, question: str) -> None:
        set_text(self.question, f"▲ {question}")
        self.question.setVisible(bool(question))
        self._fit()

    def _fit(self) -> None:
        """Take the height that the buttons and the wrapped question need."""
        self._column.activate()
        column = self._column
        # Only the question has a height for a width: without it Qt returns -1 here.
        wraps = column.hasHeightForWidth()
        self.setFixedHeight(column.totalHeightForWidth(MENU_PX) if wraps else column.totalSizeHint().height())


MORE_PX = 24
ROBOT_PX = 160
"""Largest width of the box with the robot: a name of 32 letters must not take the room of the pills."""
ROBOTS_SHOWN = 16
"""Robots in the open list; further ones are reached by its scroll bar, or by typing the first letters of a name."""


LONGEST = "■ 88:88"
"""A duration of a recording."""


class Names(QComboBox):
    """The names of the robots."""

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        return (
            self.sizeHint()
        )  # Qt's own remains that of longer names, or of another type, which were shown before


class RecordButtons(Panel):
    """The buttons that open the last recording, and begin and end one."""

    def __init__(self) -> None:
        super().__init__()
        self._view: RecordView | None = None
        self.open, self.toggle = IntentButton(), IntentButton()
        layout = spaced(QHBoxLayout(self), 4, NO_MARGINS)
        for button in (self.open, self.toggle):
            layout.addWidget(button)
            button.intent.connect(self.intent)

    def show_view(self, view: RecordView) -> None:
        """Show the buttons."""
        if view == self._view:
            return
        self._view = view
        self.toggle.show_view(view.toggle)
        if view.running:
            self.toggle.setText(f"■ {view.text}")
        set_role(self.toggle, "recording", "yes" if view.running else "")
        width, wide = self.toggle.sizeHint().width(), self.toggle.fontMetrics().horizontalAdvance
        more = max(0, wide(LONGEST) - wide(self.toggle.text()))
        self.toggle.setMinimumWidth(max(self.toggle.minimumWidth(), width + more))  # it stays under the mouse
        if view.open is not None:
            self.open.show_view(view.open)
        self.open.setVisible(view.open is not None)


class Pill(Panel):
    """State of one robot, with the buttons for its next step and lease."""

    def __init__(self, side: str, texts: Texts) -> None:
        super().__init__("pill")
        self._view: PillView | None = None
        self._emergency: ButtonView | None = None
        self.setProperty("side", side)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.title, self.state = label(role=side), ElidedLabel()
        self.notes = ElidedLabel("dim", 0)
        """notes and round trip"""
        self.next_step, self.lease = IntentButton(), IntentButton()
        self.lease.intent.connect(self.intent)
        self.next_step.setProperty("next_step", True)  # noqa: FBT003
        self.next_step.intent.connect(self.intent)
        first = filled(spaced(QHBoxLayout(), 8), self.title, (self.notes, 1))
        words = filled(spaced(QVBoxLayout(), 0), first, self.state)
        self.reason, menu = ElidedLabel("dim", 0), self._menu_button(texts)
        self.reason.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        layout = spaced(QHBoxLayout(self), None, (6, 2, 6, 2))
        filled(layout, words, (self.reason, 1), self.next_step, self.lease, menu)
        self.next_step.hide()
        self.lease.hide()

    def _menu_button(self, texts: Texts) -> QPushButton:
        self.menu, self.more = RobotMenu(self), plain_button("⋮", texts("tip.robot_menu"))
        self.more.setProperty("jog", True)  # noqa: FBT003
        self._menu_name = texts("label.robot_menu")
        self.more.setFixedWidth(MORE_PX)
        self.more.clicked.connect(lambda: self.menu.open(self.more))
        self.menu.intent.connect(self.intent)
        return self.more

    def show_state(self, view: PillView, emergency: ButtonView | None) -> None:
        """Show the robot's state; the menu ends with the button of EMERGENCY_STOP, if it is given."""
        if (view, emergency) == (self._view, self._emergency):
            return
        self._view, self._emergency = view, emergency
        self.menu.show_view(view.menu if emergency is None else (*view.menu, emergency))
        set_text(self.title, view.title)
        self.more.setAccessibleName(f"{view.title}: {self._menu_name}")
        set_role(self.state, "role", CONDITION_ROLES[view.condition])
        set_text(self.state, f"{view.symbol} {view.text}")
        set_text(self.notes, SEPARATOR.join(filter(None, (*view.notes, view.latency))))
        set_text(self.reason, " ".join(line for line in (view.reason, *view.warnings) if line))
        lines = [view.reason, *view.warnings, SEPARATOR.join(view.notes), view.details]
        self.setToolTip("\n".join(line for line in lines if line))
        self.setAccessibleName(f"{view.title}: {view.text}")
        self.setAccessibleDescription(self.toolTip())
        buttons = ((self.next_step, view.next_step), (self.lease, view.lease))
        for button, shown in buttons:  # hidden first, so that the window never needs the width of both
            if shown is None:
                button.hide()
        for button, shown in buttons:
            if shown is not None:
                button.show_view(shown)
                button.setAccessibleName(f"{view.title}: {shown.text}")
                button.show()


class Header(Panel):
    """One line above all panels."""

    keys_asked = pyqtSignal()
    """the user wants to see or hide the sheet of keys"""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._robots: tuple[str, ...] = ()
        self.robots = Names()
        self._tip = texts("tip.robot")
        self.robots.setToolTip(self._tip)
        self.robots.setAccessibleName(texts("label.robot"))
        self.robots.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)
        self.robots.setMinimumWidth(70)
        self.robots.setMaximumWidth(ROBOT_PX)
        self.robots.setMaxVisibleItems(ROBOTS_SHOWN)
        self.robots.textActivated.connect(lambda name: self.intent.emit(ChooseRobot(name)))
        self.pills = {side: Pill(side, texts) for side in SIDES}
        self.page = IntentButton()
        self.page.intent.connect(self.intent)
        self.page.hide()
        self.record = RecordButtons()
        self.menu_button = plain_button("≡", texts("tip.menu"), texts("label.menu"))
        self.menu, self.choices = self._menu(texts)
        self.menu_button.clicked.connect(self._open_menu)
        pills = ((pill, 1) for pill in self.pills.values())
        layout = spaced(QHBoxLayout(self), 4, NO_MARGINS)
        filled(layout, self.robots, self.page, *pills, self.record, self.menu_button)
        for part in (*self.pills.values(), self.record):
            part.intent.connect(self.intent)

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
                if (names := self.robots.view()) is not None:
                    widest = max(map(self.robots.fontMetrics().horizontalAdvance, robots))
                    names.setMinimumWidth(widest + MORE_PX)
                    names.setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAsNeeded)
            if self.robots.currentText() != view.robot:
                self.robots.setCurrentText(view.robot)
        self.robots.setToolTip(f"{view.robot}\n{self._tip}")
        for pill in view.pills:
            self.pills[pill.side].show_state(
                pill, view.emergency if view.choices.page is WindowPage.ROBOT else None
            )
        if view.class_page is not None:
            self.page.show_view(view.class_page.toggle)
        self.page.setVisible(view.class_page is not None)
        self.record.show_view(view.record)
        for chosen in (view.choices.theme.value, view.choices.language):
            self.choices[chosen].setChecked(True)
