"""Colours and sizes of the three themes; a test computes the contrasts."""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

from PyQt5.QtGui import QColor, QPalette
from PyQt5.QtWidgets import QApplication, QWidget

from gui.console.state.intents import Theme
from gui.console.state.views import Condition

CONDITION_ROLES = {
    Condition.ABSENT: "dim",
    Condition.SILENT: "bad",
    Condition.DISABLED: "warn",
    Condition.NOT_CALIBRATED: "warn",
    Condition.READY: "good",
    Condition.MOVING: "good",
    Condition.DRIVEN: "warn",
    Condition.FROZEN: "warn",
    Condition.FAULT: "bad",
}
"""Role in the style sheet, and colour of a `Style`, of each state."""


@dataclass(frozen=True)
class Style:
    """Colours as `#rrggbb`, and the scale of type and lengths."""

    scale: float
    ground: str
    panel: str
    field: str
    """background of boxes, lists and the pad"""
    raised: str
    """background of buttons"""
    line: str
    """borders of panels, decorative"""
    edge: str
    """outlines that must be visible: indicators, limits, focus"""
    text: str
    dim: str
    disabled: str
    accent: str
    """focus and the button to press next"""
    accent_text: str
    sim: str
    hw: str
    good: str
    warn: str
    bad: str
    notice: str
    """background of refusals and banners"""
    stop: str
    stop_pressed: str
    stop_text: str
    message: str
    """background of the last request beside STOP, dark in every theme: white would draw the eye away from STOP"""
    message_text: str

    def px(self, pixels: float) -> int:
        """Return a length (px) multiplied by the scale of this theme."""
        return round(pixels * self.scale)

    def side(self, side: str) -> str:
        """Return the colour of `sim` or `hw`."""
        return self.sim if side == "sim" else self.hw

    def condition(self, condition: Condition) -> str:
        """Return the colour of the symbol and the word of a state."""
        colour: str = getattr(self, CONDITION_ROLES[condition])
        return colour


@cache
def style_of(theme: Theme) -> Style:
    """Return the colours and sizes of a theme."""
    return Style(**tomllib.loads(_file("themes.toml"))[theme])


def _file(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


def apply_theme(window: QWidget, style: Style) -> None:
    """Apply a theme to a window and to the application's tooltips and dialogs."""
    QApplication.setPalette(palette(style))
    window.setStyleSheet(style_sheet(style))


def palette(style: Style) -> QPalette:
    """Return the palette for drawing that style sheets do not cover."""
    result = QPalette()
    roles = {
        QPalette.ColorRole.Window: style.ground,
        QPalette.ColorRole.WindowText: style.text,
        QPalette.ColorRole.Base: style.field,
        QPalette.ColorRole.AlternateBase: style.panel,
        QPalette.ColorRole.Text: style.text,
        QPalette.ColorRole.PlaceholderText: style.dim,
        QPalette.ColorRole.Button: style.raised,
        QPalette.ColorRole.ButtonText: style.text,
        QPalette.ColorRole.Light: style.edge,
        QPalette.ColorRole.Mid: style.line,
        QPalette.ColorRole.Dark: style.edge,
        QPalette.ColorRole.Highlight: style.accent,
        QPalette.ColorRole.HighlightedText: style.accent_text,
        QPalette.ColorRole.ToolTipBase: style.notice,
        QPalette.ColorRole.ToolTipText: style.text,
    }
    for role, colour in roles.items():
        result.setColor(role, QColor(colour))
    for role in (QPalette.ColorRole.WindowText, QPalette.ColorRole.Text, QPalette.ColorRole.ButtonText):
        result.setColor(QPalette.ColorGroup.Disabled, role, QColor(style.disabled))
    return result


def style_sheet(style: Style) -> str:
    """Return the style sheet of all widgets of the window."""

    def value(found: re.Match[str]) -> str:
        name, pixels, less = found.groups()
        return str(style.px(int(pixels)) - int(less or 0)) if pixels else getattr(style, name)

    marks = "bright" if QColor(style.text).lightness() > QColor(style.field).lightness() else "black"
    folder = Path(str(resources.files(__package__))) / "widgets" / "pictures" / marks
    sheet = _file("window.qss").replace("@marks", folder.as_posix())
    return re.sub(r"\$(px|\w+)(?:\((\d+)\)(?:-(\d))?)?", value, sheet)
