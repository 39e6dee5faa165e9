"""The header: robot, page of the class, states, recording, and the menu of themes and languages."""

from __future__ import annotations

from PyQt5.QtCore import QPoint, QSignalBlocker, pyqtSignal
from PyQt5.QtWidgets import QAction, QActionGroup, QComboBox, QHBoxLayout, QMenu, QPushButton, QWidget

from gui.console.state.intents import ChooseRobot, SetLanguage, SetTheme, Theme
from gui.console.state.views import View
from gui.console.texts import LANGUAGES, Texts
from gui.window.widgets.controls import IntentButton
from gui.window.widgets.pills import Pill
from gui.window.widgets.record import Record


class Header(QWidget):
    """One line above all panels."""

    intent = pyqtSignal(object)
    keys_asked = pyqtSignal()
    """the user wants to see or hide the sheet of keys"""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self._robots: tuple[str, ...] = ()
        self.robots = QComboBox()
        self.robots.setToolTip(texts("tip.robot"))
        self.robots.setAccessibleName(texts("label.robot"))
        self.robots.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)
        self.robots.setMinimumWidth(70)
        self.robots.textActivated.connect(lambda name: self.intent.emit(ChooseRobot(name)))
        self.pills = {side: Pill(side) for side in ("sim", "hw")}
        self.page = IntentButton()
        self.page.intent.connect(self.intent)
        self.page.hide()
        self.record = Record()
        self.menu_button = QPushButton("≡")
        self.menu_button.setAutoDefault(False)
        self.menu_button.setToolTip(texts("tip.menu"))
        self.menu_button.setAccessibleName(texts("label.menu"))
        self.menu, self.choices = self._menu(texts)
        self.menu_button.clicked.connect(self._open_menu)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addWidget(self.robots)
        layout.addWidget(self.page)
        for pill in self.pills.values():
            layout.addWidget(pill, 1)
            pill.intent.connect(self.intent)
        layout.addWidget(self.record)
        layout.addWidget(self.menu_button)
        self.record.intent.connect(self.intent)

    def _menu(self, texts: Texts) -> tuple[QMenu, dict[str, QAction]]:
        menu, choices = QMenu(self), {}
        themes = QActionGroup(menu)
        self._heading(menu, texts("label.theme"))
        for theme in Theme:
            choices[theme.value] = self._choice(menu, texts(f"label.theme_{theme}"), SetTheme(theme))
            themes.addAction(choices[theme.value])
        languages = QActionGroup(menu)
        self._heading(menu, texts("label.language"))
        for code in LANGUAGES:
            choices[code] = self._choice(menu, texts(f"label.language_{code}"), SetLanguage(code))
            languages.addAction(choices[code])
        menu.addSeparator()
        keys = QAction(f"{texts('label.keys')}\tF1", menu)
        keys.triggered.connect(self.keys_asked)
        menu.addAction(keys)
        return menu, choices

    @staticmethod
    def _heading(menu: QMenu, text: str) -> None:
        """Add a heading as a disabled line: Fusion does not draw the text of sections."""
        menu.addSeparator()
        heading = QAction(text, menu)
        heading.setEnabled(False)
        menu.addAction(heading)

    def _choice(self, menu: QMenu, text: str, intent: SetTheme | SetLanguage) -> QAction:
        action = QAction(text, menu)
        action.setCheckable(True)
        action.triggered.connect(lambda: self.intent.emit(intent))
        menu.addAction(action)
        return action

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
            if self.robots.currentText() != view.robot:
                self.robots.setCurrentText(view.robot)
        for pill in view.pills:
            self.pills[pill.side].show_view(pill)
        if view.class_page is not None:
            self.page.show_view(view.class_page.toggle)
        self.page.setVisible(view.class_page is not None)
        self.record.show_view(view.record)
        self.choices[view.theme.value].setChecked(True)
        if view.language in self.choices:
            self.choices[view.language].setChecked(True)
