"""The sheet of keys, over the panels until the user presses F1 again, or Close."""

from __future__ import annotations

from PyQt5.QtWidgets import QFrame, QGridLayout, QPushButton, QWidget

from gui.console.texts import Texts
from gui.window.widgets.controls import label

KEYS = ("stop", "send", "pad", "yaw", "press", "undo", "record", "class", "tab", "help")


class KeySheet(QFrame):
    """All keys of the window; not a dialog, so that STOP stays usable."""

    def __init__(self, texts: Texts, parent: QWidget) -> None:
        super().__init__(parent)
        self.setProperty("notice", True)  # noqa: FBT003
        self.setAccessibleName(texts("label.keys"))
        layout = QGridLayout(self)
        layout.setContentsMargins(20, 14, 20, 14)
        layout.setHorizontalSpacing(24)
        layout.addWidget(label(texts("label.keys"), "large"), 0, 0, 1, 2)
        for row, name in enumerate(KEYS, start=1):
            keys, _, meaning = texts(f"label.keys_{name}").partition(": ")
            layout.addWidget(label(keys, "title"), row, 0)
            layout.addWidget(label(meaning), row, 1)
        self.close_button = QPushButton(texts("label.dismiss"))
        self.close_button.setAutoDefault(False)
        self.close_button.setToolTip(texts("label.keys_help"))
        self.close_button.setAccessibleName(texts("label.dismiss"))
        self.close_button.clicked.connect(self.hide)
        layout.addWidget(self.close_button, len(KEYS) + 1, 1)
        self.hide()

    def toggle(self) -> None:
        """Show the sheet in the middle, or hide it."""
        self.setVisible(self.isHidden())
        if self.isVisible():
            self.place()
            self.raise_()
            self.close_button.setFocus()

    def place(self) -> None:
        """Move to the middle of the parent."""
        parent = self.parentWidget()
        if parent is not None:
            self.adjustSize()
            self.move((parent.width() - self.width()) // 2, max(0, (parent.height() - self.height()) // 2))
