"""The list of ports to connect hardware with."""

from __future__ import annotations

from PyQt5.QtCore import pyqtSignal
from PyQt5.QtWidgets import QFrame, QHBoxLayout, QVBoxLayout, QWidget

from gui.console.state.views import ConnectView
from gui.console.texts import Texts
from gui.window.widgets.controls import IntentButton, label, set_text

WIDTH_PX = 440


class ConnectSheet(QFrame):
    """A frame over the middle of the panels; not a dialog, so that STOP stays usable."""

    intent = pyqtSignal(object)

    def __init__(self, texts: Texts, parent: QWidget) -> None:
        super().__init__(parent)
        self._view: ConnectView | None = None
        self.setProperty("notice", True)  # noqa: FBT003
        self.setAccessibleName(texts("connect.title"))
        self.text = label(wrap=True)
        self.ports: list[IntentButton] = []
        self._list = QVBoxLayout()
        self._list.setSpacing(6)
        self.again, self.close_button = self._button(), self._button()
        buttons = QHBoxLayout()
        buttons.addWidget(self.again)
        buttons.addStretch(1)
        buttons.addWidget(self.close_button)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(20, 14, 20, 14)
        layout.setSpacing(12)
        layout.addWidget(label(texts("connect.title"), "large"))
        layout.addWidget(self.text)
        layout.addLayout(self._list)
        layout.addLayout(buttons)
        self.hide()

    def _button(self) -> IntentButton:
        button = IntentButton()
        button.intent.connect(self.intent)
        return button

    def show_view(self, view: ConnectView | None) -> None:
        """Show the list, or hide it."""
        if view == self._view:
            return
        appears, self._view = self._view is None, view
        if view is None:
            self.hide()
            return
        set_text(self.text, view.text)
        self.text.setToolTip(view.details)
        while len(self.ports) < len(view.ports):
            self.ports.append(self._button())
            self._list.addWidget(self.ports[-1])
        for button, shown in zip(self.ports, view.ports, strict=False):
            button.show_view(shown)
        for number, button in enumerate(self.ports):
            button.setVisible(number < len(view.ports))
        self.again.show_view(view.again)
        self.close_button.show_view(view.close)
        self.show()
        self.place()
        self.raise_()
        if appears:
            self.close_button.setFocus()

    def place(self) -> None:
        """Move to the middle of the parent."""
        parent, layout = self.parentWidget(), self.layout()
        if parent is None:
            return
        width = min(max(WIDTH_PX, layout.minimumSize().width()), parent.width())
        height = max(layout.totalHeightForWidth(width), layout.minimumSize().height())
        self.setGeometry(
            (parent.width() - width) // 2, max(0, (parent.height() - height) // 2), width, height
        )
