"""Colours and sizes of the three themes; a test computes the contrasts."""

from __future__ import annotations

from dataclasses import dataclass

from PyQt5.QtGui import QColor, QPalette
from PyQt5.QtWidgets import QApplication, QWidget

from gui.console.state.intents import Theme
from gui.console.state.views import Condition

BASE_PX = 13
"""Type size at scale 1."""
STOP_PX = 72
"""Height of the STOP bar in every theme."""
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


DARK = Style(
    scale=1.0,
    ground="#12161b",
    panel="#1b2128",
    field="#0f1317",
    raised="#2a323c",
    line="#36414d",
    edge="#8795a3",
    text="#eaeff4",
    dim="#aab6c1",
    disabled="#808c98",
    accent="#d8e2ec",
    accent_text="#12161b",
    sim="#5aa9ff",
    hw="#ff9f45",
    good="#63d693",
    warn="#f0c24f",
    bad="#ff8a84",
    notice="#33291a",
    stop="#c1121b",
    stop_pressed="#8f0d14",
    stop_text="#ffffff",
)
LIGHT = Style(
    scale=1.0,
    ground="#e9edf1",
    panel="#fbfcfd",
    field="#ffffff",
    raised="#eef1f5",
    line="#c3ccd5",
    edge="#66727e",
    text="#141c24",
    dim="#47535f",
    disabled="#78838e",
    accent="#22303d",
    accent_text="#ffffff",
    sim="#0b5cad",
    hw="#a34708",
    good="#176a38",
    warn="#765000",
    bad="#b3141b",
    notice="#fff1cf",
    stop="#c1121b",
    stop_pressed="#8f0d14",
    stop_text="#ffffff",
)
PROJECTOR = Style(
    scale=1.25,
    ground="#f2f2f2",
    panel="#ffffff",
    field="#ffffff",
    raised="#f0f0f0",
    line="#9aa2aa",
    edge="#4a525a",
    text="#000000",
    dim="#303840",
    disabled="#6d757d",
    accent="#101820",
    accent_text="#ffffff",
    sim="#004a9e",
    hw="#963c00",
    good="#0e5a2c",
    warn="#664400",
    bad="#a80f16",
    notice="#ffeebf",
    stop="#b80f18",
    stop_pressed="#8a0b12",
    stop_text="#ffffff",
)


def style_of(theme: Theme) -> Style:
    """Return the colours and sizes of a theme."""
    return {Theme.DARK: DARK, Theme.LIGHT: LIGHT, Theme.PROJECTOR: PROJECTOR}[theme]


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
    return _surfaces(style) + _controls(style) + _words(style)


def _surfaces(style: Style) -> str:
    return f"""
* {{ font-size: {style.px(BASE_PX)}px; }}
QMainWindow, QWidget#central {{ background: {style.ground}; }}
QDialog {{ background: {style.panel}; }}
QFrame[panel="true"] {{ background: {style.panel}; border: 1px solid {style.line}; border-radius: 4px; }}
QFrame[notice="true"] {{ background: {style.notice}; border: 2px solid {style.warn}; border-radius: 4px; }}
QFrame[pill="true"] {{ background: {style.panel}; border: 1px solid {style.line}; border-radius: 4px; }}
QFrame[side="sim"] {{ border-left: 5px solid {style.sim}; }}
QFrame[side="hw"] {{ border-left: 5px solid {style.hw}; }}
QToolTip {{ background: {style.notice}; color: {style.text}; border: 1px solid {style.warn}; padding: 3px; }}
QTabWidget::pane {{ background: {style.panel}; border: 1px solid {style.line}; border-radius: 4px; top: -1px; }}
QTabBar::tab {{ background: {style.ground}; color: {style.dim}; border: 1px solid {style.line};
  border-top-left-radius: 4px; border-top-right-radius: 4px; padding: {style.px(4)}px {style.px(4)}px; }}
QTabBar::tab:selected {{ background: {style.panel}; color: {style.text}; border-bottom-color: {style.panel}; }}
QTabBar::tab:focus {{ border: 2px solid {style.accent}; }}
QMenu, QListView, QTreeView, QComboBox QAbstractItemView {{ background: {style.field}; color: {style.text};
  border: 1px solid {style.line}; selection-background-color: {style.accent};
  selection-color: {style.accent_text}; }}
QMenu::item {{ padding: {style.px(4)}px {style.px(20)}px; }}
QMenu::item:selected {{ background: {style.accent}; color: {style.accent_text}; }}
QMenu::item:disabled {{ color: {style.dim}; background: {style.field}; }}
QListView:focus, QTreeView:focus {{ border: 1px solid {style.accent}; }}
QHeaderView::section {{ background: {style.raised}; color: {style.text}; border: none;
  border-right: 1px solid {style.line}; padding: {style.px(3)}px {style.px(4)}px; }}
"""


def _controls(style: Style) -> str:
    return f"""
QPushButton {{ background: {style.raised}; border: 1px solid {style.edge}; border-radius: 4px;
  padding: {style.px(3)}px {style.px(8)}px; min-height: {style.px(17)}px; }}
QPushButton:hover {{ border-color: {style.accent}; }}
QPushButton:pressed {{ background: {style.line}; }}
QPushButton:focus {{ border: 2px solid {style.accent}; padding: {style.px(3) - 1}px {style.px(8) - 1}px; }}
QPushButton:disabled {{ color: {style.disabled}; border-color: {style.line}; background: {style.panel}; }}
QPushButton[main="true"]:enabled {{ background: {style.accent}; color: {style.accent_text}; font-weight: bold; }}
QPushButton[main="true"]:focus {{ border: 2px solid {style.edge}; }}
QPushButton[next_step="true"]:enabled, QPushButton[armed="yes"] {{ border: 2px solid {style.warn}; font-weight: bold;
  padding: {style.px(2) - 1}px {style.px(7)}px; }}
QPushButton[jog="true"] {{ font-weight: bold; font-size: {style.px(16)}px; padding: 0px; }}
QPushButton#stop {{ background: {style.stop}; color: {style.stop_text}; border: none; border-radius: 0px;
  padding: 0px; min-height: {STOP_PX}px; max-height: {STOP_PX}px; }}
QPushButton#stop:focus {{ border: 3px solid {style.stop_text}; }}
QPushButton#stop:pressed {{ background: {style.stop_pressed}; }}
QPushButton#emergency {{ background: {style.stop_pressed}; color: {style.stop_text}; font-weight: bold;
  border: 2px solid {style.stop_text}; min-height: {style.px(26)}px; }}
QPushButton#emergency:focus, QPushButton#emergency[armed="yes"] {{ background: {style.stop_text}; color: {style.stop}; }}
QLineEdit, QDoubleSpinBox, QComboBox {{ background: {style.field}; border: 1px solid {style.edge};
  border-radius: 3px; padding: 1px {style.px(4)}px; min-height: {style.px(19)}px;
  selection-background-color: {style.accent}; selection-color: {style.accent_text}; }}
QLineEdit:focus, QDoubleSpinBox:focus, QComboBox:focus {{ border: 2px solid {style.accent}; padding: 0px {style.px(4) - 1}px; }}
QLineEdit:disabled, QDoubleSpinBox:disabled {{ color: {style.disabled}; border-color: {style.line}; }}
QDoubleSpinBox::up-button, QDoubleSpinBox::down-button {{ width: 0px; border: none; }}
QComboBox::drop-down {{ border: none; width: {style.px(14)}px; }}
QComboBox::down-arrow {{ image: none; width: 0px; height: 0px; border-left: 4px solid {style.field};
  border-right: 4px solid {style.field}; border-top: 6px solid {style.edge}; }}
QSlider::groove:horizontal {{ height: 4px; background: {style.line}; border-radius: 2px; }}
QSlider::sub-page:horizontal {{ background: {style.edge}; border-radius: 2px; }}
QSlider::handle:horizontal {{ background: {style.text}; width: {style.px(12)}px; margin: -{style.px(5)}px 0px;
  border-radius: {style.px(6)}px; border: 1px solid {style.panel}; }}
QSlider::handle:horizontal:focus {{ border: 2px solid {style.accent}; background: {style.panel}; }}
QProgressBar {{ background: {style.field}; border: 1px solid {style.edge}; border-radius: 3px;
  max-height: {style.px(8)}px; min-height: {style.px(8)}px; }}
QProgressBar::chunk {{ background: {style.hw}; }}
"""


def _words(style: Style) -> str:
    return f"""
QLabel {{ background: transparent; }}
QLabel[role="dim"] {{ color: {style.dim}; }}
QLabel[role="title"] {{ font-weight: bold; }}
QLabel[role="large"] {{ font-size: {style.px(15)}px; font-weight: bold; }}
QLabel[role="sim"] {{ color: {style.sim}; }}
QLabel[role="hw"] {{ color: {style.hw}; font-weight: bold; }}
QLabel[role="good"] {{ color: {style.good}; font-weight: bold; }}
QLabel[role="warn"] {{ color: {style.warn}; font-weight: bold; }}
QLabel[role="bad"] {{ color: {style.bad}; font-weight: bold; }}
QLabel[role="stop"] {{ color: {style.stop_text}; }}
QLabel[role="stop_word"] {{ color: {style.stop_text}; font-size: {style.px(26)}px; font-weight: bold; }}
"""
