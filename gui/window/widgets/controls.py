"""Controls that several panels use; they show views and report the user's input."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from typing import Never, TypeVar

from PyQt5.QtCore import QEvent, QSignalBlocker, QSize, Qt, QTimer, pyqtBoundSignal, pyqtSignal
from PyQt5.QtGui import QFocusEvent, QHideEvent, QPainter, QPaintEvent
from PyQt5.QtWidgets import (
    QBoxLayout,
    QCheckBox,
    QComboBox,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLayout,
    QPushButton,
    QSlider,
    QVBoxLayout,
    QWidget,
)

from gui.console.state.intents import Choose, Theme
from gui.console.state.views import ButtonView
from gui.console.texts import Texts
from gui.window.widgets.number_box import NumberBox

STEPS = 10
"""Positions of a slider per unit."""
TOOLTIP_CHARACTERS = 72
"""Longest line of a tooltip."""
NAMES_CHARACTERS = 18
"""Number of characters that always fit into a label with a name."""
SEPARATOR = " · "
ARMED_MS = 6000
"""Time in which a button with a question accepts its second press."""


NO_MARGINS = 0, 0, 0, 0
LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
RIGHT = Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
Margins = tuple[int, int, int, int]
Part = QWidget | QLayout | tuple[QWidget | QLayout, int] | None
L = TypeVar("L", bound=QLayout)
B = TypeVar("B", bound=QBoxLayout)
W = TypeVar("W", bound=QWidget)


def spaced(layout: L, gap: int | None, margins: Margins | None = None) -> L:
    """Return the layout with this gap between its parts and these margins (px); None: those of the style."""
    if gap is not None:
        layout.setSpacing(gap)
    if margins is not None:
        layout.setContentsMargins(*margins)
    return layout


def filled(layout: B, *parts: Part) -> B:
    """Return the layout after adding parts to it, with their stretch if it is given; None: a gap that stretches."""
    for part in parts:
        item, stretch = part if isinstance(part, tuple) else (part, 0)
        if item is None:
            layout.addStretch(1)
        elif isinstance(item, QLayout):
            layout.addLayout(item, stretch)
        else:
            layout.addWidget(item, stretch)
    return layout


def in_row(
    *parts: Part, gap: int | None = None, margins: Margins | None = None, inside: QWidget | None = None
) -> QHBoxLayout:
    """Return a layout of parts beside each other, as `filled` and `spaced` do; `inside` has it as its layout."""
    return filled(spaced(QHBoxLayout(inside), gap, margins), *parts)  # type: ignore[arg-type]  # None is no parent


def in_column(
    *parts: Part, gap: int | None = None, margins: Margins | None = None, inside: QWidget | None = None
) -> QVBoxLayout:
    """Return a layout of parts below each other, like `in_row`."""
    return filled(spaced(QVBoxLayout(inside), gap, margins), *parts)  # type: ignore[arg-type]


def in_lines(tooltip: str) -> str:
    """Return a tooltip with line breaks: Qt shows a long one in a single line."""
    return "\n".join(textwrap.fill(line, TOOLTIP_CHARACTERS) for line in tooltip.splitlines())


def named(control: W, name: str, tooltip: str) -> W:
    """Return the control, with a name and a tooltip; screen readers say both."""
    control.setAccessibleName(name)
    control.setToolTip(in_lines(tooltip))
    return control


def plain_button(text: str, tooltip: str, name: str = "") -> QPushButton:
    """Return a button whose name for screen readers is its text by default."""
    return named(QPushButton(text), name or text, tooltip)


class IntentButton(QPushButton):
    """A button that reports the intent of its view; if the view has a question, only at the second press."""

    intent = pyqtSignal(object)
    asking = pyqtSignal(str)
    """the question, while the button waits for the second press; empty: it no longer waits"""

    def __init__(self, *, main: bool = False) -> None:
        super().__init__()
        self._view: ButtonView | None = None
        self._armed = QTimer(self)
        self._armed.setSingleShot(True)
        self._armed.setInterval(ARMED_MS)
        self._armed.timeout.connect(self.disarm)
        self.setProperty("main", main)
        self.clicked.connect(self._press)

    def show_view(self, view: ButtonView | None, about: str = "") -> None:
        """Show the view's text and tooltip, and enable or disable the button; without a view, hide it.

        Screen readers say what the button is about before its text.
        """
        if view is not None and view != self._view:
            self._view = view
            named(self, f"{about} {view.text}".lstrip(), view.tooltip)
            self.setEnabled(view.enabled)
            self._show_text()
        self.setVisible(view is not None)

    def disarm(self) -> None:
        """Wait for the first press again."""
        if self.property("armed"):
            self._armed.stop()
            set_role(self, "armed", "")
            self._show_text()
            self.asking.emit("")

    def focusOutEvent(self, event: QFocusEvent) -> None:  # noqa: N802
        super().focusOutEvent(event)
        self.disarm()

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802
        super().hideEvent(event)
        self.disarm()

    def _press(self) -> None:
        if self._view is None:
            return
        if self._view.question and not self.property("armed"):
            self.setFocus()
            set_role(self, "armed", "yes")
            self._show_text()
            self._armed.start()
            self.asking.emit(self._view.question)
            return
        self.disarm()
        self.intent.emit(self._view.intent)

    def _show_text(self) -> None:
        if self._view is not None:
            text = self._view.text.replace("&", "&&")
            self.setText(f"{text}?" if self.property("armed") else text)


def show_each(
    views: Sequence[ButtonView],
    buttons: list[IntentButton],
    made: Callable[[ButtonView], IntentButton],
    about: str = "",
) -> None:
    """Show a button for each view; `made` makes those that are missing, and those left over are hidden."""
    for number, view in enumerate(views):
        if number == len(buttons):
            buttons.append(made(view))
        buttons[number].show_view(view, about)
    for button in buttons[len(views) :]:
        button.hide()


class Panel(QFrame):
    """A part of the window: it shows its part of a view, and reports intents."""

    intent = pyqtSignal(object)

    def __init__(self, look: str = "", parent: QWidget | None = None) -> None:
        """Create it; `look` is its name in the style sheet, for example `panel`."""
        super().__init__(parent)
        if look:
            self.setProperty(look, True)  # noqa: FBT003

    def reports(self, *intents: pyqtBoundSignal) -> None:
        """Report the intents of these signals of its parts."""
        for intent in intents:
            intent.connect(self.intent)

    def button(self, *, main: bool = False) -> IntentButton:
        """Return a button whose intents this panel reports."""
        button = IntentButton(main=main)
        self.reports(button.intent)
        return button

    def show_view(self, view: Never) -> None:
        """Show the part of the view with which the panel was added to the window; the plots show none."""

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme that the style sheet does not set."""


class Sheet(Panel):
    """A frame over the middle of its parent; not a dialog, so that STOP stays usable."""

    def __init__(self, name: str, parent: QWidget, least: int = 0) -> None:
        """Create it hidden; `least` is its least width (px) if the parent is as wide."""
        super().__init__("notice", parent)
        self._least = least
        self.setAccessibleName(name)
        self.hide()

    def appear(self, focus: QWidget) -> None:
        """Show the sheet, and give the focus to one of its controls; nothing if it is shown."""
        if self.isHidden():
            self.show()
            self.place()
            self.raise_()
            focus.setFocus()

    def event(self, event: QEvent) -> bool:
        """Take the height that the texts need when a text has changed: Qt measures the inner panels only now."""
        handled = super().event(event)
        if event.type() == QEvent.Type.LayoutRequest and self.isVisible():
            self.place()
        return handled

    def place(self) -> None:
        """Move to the middle of the parent."""
        room, layout = self.parentWidget().size(), self.layout()
        width = min(max(self._least, layout.minimumSize().width()), room.width())
        height = max(layout.totalHeightForWidth(width), layout.minimumSize().height())
        self.setGeometry((room.width() - width) // 2, max(0, (room.height() - height) // 2), width, height)


class ChoiceCheck(QCheckBox):
    """The box of a choice that is on or off; the window shows its present value with each view."""

    intent = pyqtSignal(object)

    def __init__(self, texts: Texts, name: str) -> None:
        super().__init__(texts(f"label.{name}"))
        self.name = name
        named(self, self.text(), texts(f"tip.{name}"))
        self.clicked.connect(lambda on: self.intent.emit(Choose(name, value=on)))


class NameBox(QComboBox):
    """A choice of names; it and its list are as wide as the style sheet says, and the list scrolls."""

    def __init__(self) -> None:
        super().__init__()
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToContents)
        self.view().setVerticalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAsNeeded)

    def minimumSizeHint(self) -> QSize:  # noqa: N802 - Qt's own remains that of longer names that were shown before
        return self.sizeHint()


class SliderBox(QWidget):
    """A choice that is a number, as a slider and as a box."""

    intent = pyqtSignal(object)

    def __init__(self, texts: Texts, name: str, *, least: float) -> None:
        super().__init__()
        title, unit = texts(f"label.{name}"), texts(f"label.{name}_unit")
        self.slider = QSlider(Qt.Orientation.Horizontal)
        self.slider.setMinimum(round(least * STEPS))
        self.slider.setSingleStep(STEPS)
        self.slider.setPageStep(5 * STEPS)
        self.slider.setMinimumWidth(60)
        self.box = NumberBox(texts, unit, least)
        for control in (self.slider, self.box):
            named(control, f"{title} ({unit.strip()})", texts(f"tip.{name}"))
        in_row(QLabel(title), (self.slider, 1), self.box, gap=6, margins=NO_MARGINS, inside=self)
        self.slider.valueChanged.connect(lambda at: self.intent.emit(Choose(name, at / STEPS)))
        self.box.valueChanged.connect(lambda value: self.intent.emit(Choose(name, value)))

    def show_compact(self, *, compact: bool) -> None:
        """Hide the slider, so that two boxes fit into one row."""
        self.slider.setVisible(not compact)

    def show_value(self, value: float, maximum: float) -> None:
        """Show the number with its maximum."""
        maximum = round(maximum, 1)  # as the box does
        if (round(value, 1), maximum) == (self.box.value(), self.box.maximum()):
            return  # else it would replace what the user is typing
        with QSignalBlocker(self.slider), QSignalBlocker(self.box):
            self.slider.setMaximum(round(maximum * STEPS))
            self.slider.setValue(round(value * STEPS))
            self.box.setMaximum(maximum)
            self.box.setValue(value)


class ElidedLabel(QLabel):
    """A label for text of any length: it is elided, and then its tooltip contains all of it."""

    def __init__(self, role: str = "", least: int = NAMES_CHARACTERS) -> None:
        """Create it empty; `least` characters always fit."""
        super().__init__()
        self.least = least
        self.setProperty("role", role)
        self.setTextFormat(Qt.TextFormat.PlainText)

    def minimumSizeHint(self) -> QSize:  # noqa: N802
        size, metrics = super().minimumSizeHint(), self.fontMetrics()
        return QSize(min(size.width(), self.least * metrics.averageCharWidth()), size.height())

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802
        shown = self.fontMetrics().elidedText(self.text(), Qt.TextElideMode.ElideRight, self.width())
        self.setToolTip("" if shown == self.text() else self.text())
        painter = QPainter(self)
        painter.setPen(self.palette().color(self.palette().WindowText))
        painter.drawText(self.rect(), int(LEFT), shown)


def label(text: str = "", role: str = "", *, wrap: bool = False, right: bool = False) -> QLabel:
    """Return a label in one of the style sheet's roles, whose text wraps or stands at the right."""
    result = QLabel(text)
    result.setAlignment(RIGHT if right else LEFT)
    result.setProperty("role", role)
    result.setWordWrap(wrap)
    result.setTextFormat(Qt.TextFormat.PlainText)
    return result


def set_role(widget: QWidget, name: str, value: str) -> None:
    """Change a property by which the style sheet selects widgets, and apply the style."""
    if widget.property(name) == value:
        return
    widget.setProperty(name, value)
    style = widget.style()
    if style is not None:
        style.unpolish(widget)
        style.polish(widget)
