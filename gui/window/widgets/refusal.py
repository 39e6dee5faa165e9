"""A refusal beside the control of the request: the sentence, the alternative, and a button to hide it."""

from __future__ import annotations

from PyQt5.QtCore import QPoint, pyqtSignal
from PyQt5.QtWidgets import QFrame, QHBoxLayout, QVBoxLayout, QWidget

from gui.console.state.intents import DismissRefusal
from gui.console.state.views import ButtonView, RefusalView
from gui.console.texts import Texts
from gui.window.widgets.controls import IntentButton, label, set_text

WIDTH_PX = 290
GAP_PX = 4


class Refusal(QFrame):
    """A frame over the panels next to the control, so that no control moves; also shows questions of buttons."""

    intent = pyqtSignal(object)

    def __init__(self, texts: Texts, parent: QWidget) -> None:
        super().__init__(parent)
        self._shown: tuple[str, ButtonView | None, QWidget | None, bool] = ("", None, None, True)
        self.setProperty("notice", True)  # noqa: FBT003
        self.text = label(wrap=True)
        self.alternative, self.dismiss = IntentButton(main=True), IntentButton()
        close = texts("label.dismiss")
        self.dismiss.show_view(ButtonView(close, texts("tip.dismiss"), DismissRefusal()))
        self.alternative.intent.connect(self.intent)
        self.dismiss.intent.connect(self.intent)
        buttons = QHBoxLayout()
        buttons.addWidget(self.alternative, 1)
        buttons.addWidget(self.dismiss)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(10, 8, 10, 8)
        layout.addWidget(self.text)
        layout.addLayout(buttons)
        self.hide()

    def show_view(self, view: RefusalView | None, beside: QWidget | None) -> None:
        """Show the refusal beside a widget, or hide it."""
        if view is None:
            self._show("", None, None, closes=True)
        else:
            self._show(f"✕ {view.text}", view.alternative, beside, closes=True)

    def show_question(self, question: str, beside: QWidget) -> None:
        """Show the question of a button that waits for its second press."""
        self._show(f"▲ {question}", None, beside, closes=False)

    def _show(
        self, text: str, alternative: ButtonView | None, beside: QWidget | None, *, closes: bool
    ) -> None:
        shown = (text, alternative, beside, closes)
        if shown == self._shown:
            self.place()  # the widget beside it may have moved
            return
        self._shown = shown
        if not text or beside is None:
            self.hide()
            return
        set_text(self.text, text)
        self.setAccessibleName(text)
        if alternative is not None:
            self.alternative.show_view(alternative)
        self.alternative.setVisible(alternative is not None)
        self.dismiss.setVisible(closes)
        self.place()
        self.show()
        self.raise_()

    def place(self) -> None:
        """Move to the right of the widget, or to its left if there is no room."""
        parent, beside = self.parentWidget(), self._shown[2]
        if beside is None:
            return
        width = max(WIDTH_PX, self.minimumSizeHint().width())
        height = self.heightForWidth(width)
        level = beside.height() - height
        corner = beside.mapTo(parent, QPoint(beside.width() + GAP_PX, level))
        if corner.x() + width > parent.width():
            corner.setX(beside.mapTo(parent, QPoint(0, 0)).x() - width - GAP_PX)
        corner.setX(max(0, corner.x()))
        corner.setY(max(0, min(corner.y(), parent.height() - height)))
        self.setGeometry(corner.x(), corner.y(), width, height)
