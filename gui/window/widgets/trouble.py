"""The line for unexpected errors of the window, which continues after them."""

from __future__ import annotations

from PyQt5.QtWidgets import QFrame, QHBoxLayout, QPushButton, QWidget

from gui.console.texts import Texts
from gui.window.widgets.controls import label, set_text


class Trouble(QFrame):
    """A line over the lower edge of the panels, until the user closes it."""

    def __init__(self, texts: Texts, parent: QWidget) -> None:
        super().__init__(parent)
        self.setProperty("notice", True)  # noqa: FBT003
        self.text = label(wrap=True)
        self.close_button = QPushButton(texts("label.dismiss"))
        self.close_button.setAutoDefault(False)
        self.close_button.setToolTip(texts("tip.dismiss"))
        self.close_button.setAccessibleName(texts("label.dismiss"))
        self.close_button.clicked.connect(self.hide)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(10, 4, 6, 4)
        layout.addWidget(self.text, 1)
        layout.addWidget(self.close_button)
        self.hide()

    def show_text(self, text: str) -> None:
        """Show an error."""
        set_text(self.text, f"✕ {text}")
        self.setAccessibleName(text)
        self.show()
        self.place()
        self.raise_()

    def place(self) -> None:
        """Move to the lower edge of the parent, above STOP."""
        parent = self.parentWidget()
        if parent is not None:
            height = max(self.sizeHint().height(), self.heightForWidth(parent.width()))
            self.setGeometry(0, parent.height() - height, parent.width(), height)
