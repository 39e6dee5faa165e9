"""Gestures as buttons with pictures, and the program that follows a face."""

from __future__ import annotations

from importlib import resources

from PyQt5.QtCore import QByteArray, QRectF, QSize, Qt, pyqtSignal
from PyQt5.QtGui import QIcon, QPixmap, QResizeEvent
from PyQt5.QtSvg import QSvgRenderer
from PyQt5.QtWidgets import QGridLayout, QSizePolicy, QToolButton

from beatrix_zenoh.client.choreography import GESTURES
from gui.console.state.intents import Intent, Theme
from gui.console.state.views import ButtonView, GesturesView
from gui.console.texts import Texts
from gui.window.theme import style_of
from gui.window.widgets.controls import Panel, set_role, spaced
from gui.window.widgets.head3d_paint import painted

PICTURE_PX = 26
"""Side of a picture at scale 1."""
COLUMNS = 5
AIR_PX = 12
"""Width beside the name of a button."""


class PictureButton(QToolButton):
    """A button with a picture over its text."""

    intent = pyqtSignal(object)

    def __init__(self, picture: str) -> None:
        super().__init__()
        self._picture = picture
        self._intent: Intent | None = None
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Ignored)
        self.clicked.connect(lambda: self.intent.emit(self._intent))

    def show_view(self, view: ButtonView) -> None:
        """Show the view's text, and enable or disable the button."""
        self._intent = view.intent
        self.setText(view.text.replace("&", "&&"))
        self.setToolTip(f"{view.text}: {view.tooltip}")
        self.setAccessibleName(view.text)
        self.setEnabled(view.enabled)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        colours, ratio = style_of(theme), self.devicePixelRatioF()
        icon, side = QIcon(), colours.px(PICTURE_PX)
        for mode, line, mark in (
            (QIcon.Mode.Normal, colours.text, colours.accent),
            (QIcon.Mode.Disabled, colours.disabled, colours.disabled),
        ):
            icon.addPixmap(drawn(self._picture, side, ratio, (line, colours.field, mark)), mode)
        self.setIcon(icon)
        self.setIconSize(QSize(side, side))


def drawn(name: str, side: int, ratio: float, colours: tuple[str, str, str]) -> QPixmap:
    """Return a picture with a side (px) on a screen with this ratio of pixels; colours of line, face and mark."""
    text = resources.files(__package__).joinpath("pictures", f"{name}.svg").read_text(encoding="utf-8")
    for variable, colour in zip(("currentColor", "var(--face)", "var(--mark)"), colours, strict=True):
        text = text.replace(variable, colour)
    with painted(side, side, ratio) as (image, painter):
        QSvgRenderer(QByteArray(text.encode())).render(painter, QRectF(0, 0, side, side))
    return QPixmap.fromImage(image)


class GesturesPanel(Panel):
    """A button for each gesture; after them the program that follows a face."""

    def __init__(self, texts: Texts) -> None:
        super().__init__()
        self.buttons = {name: PictureButton(name) for name in GESTURES}
        self.follow, self.open = PictureButton("follow"), PictureButton("program")
        self.setAccessibleName(texts("label.gestures"))
        self._all = (*self.buttons.values(), self.follow, self.open)
        grid = spaced(QGridLayout(self), 3, (3, 3, 3, 3))
        self.reports(*(button.intent for button in self._all))
        for number, button in enumerate(self._all):
            grid.addWidget(button, *divmod(number, COLUMNS))
            grid.setRowStretch(number // COLUMNS, 1)

    def show_theme(self, theme: Theme) -> None:
        """Use the colours and sizes of a theme."""
        for button in self._all:
            button.show_theme(theme)
        self._show_names()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802
        super().resizeEvent(event)
        self._show_names()

    def _show_names(self) -> None:
        """Show the names below the pictures if all of them fit; tooltips contain them, too."""
        widest = max(self.fontMetrics().horizontalAdvance(button.text()) for button in self._all)
        styles = Qt.ToolButtonStyle
        fit = widest + AIR_PX < self.width() / COLUMNS
        for button in self._all:
            button.setToolButtonStyle(styles.ToolButtonTextUnderIcon if fit else styles.ToolButtonIconOnly)

    def show_view(self, view: GesturesView) -> None:
        """Show the buttons, and what the program does."""
        for name, button_view in view.gestures:
            self.buttons[name].show_view(button_view)
        self.follow.show_view(view.follow)
        self.open.show_view(view.open)
        set_role(self.follow, "running", "yes" if view.following else "")
        self._show_names()
