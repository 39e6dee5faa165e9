"""What lies over the panels: the next action needed, errors, a refusal, and the sheet that connects."""

from __future__ import annotations

from itertools import zip_longest

from PyQt5.QtCore import QRect
from PyQt5.QtWidgets import QFileDialog, QLineEdit, QSizePolicy, QWidget

from gui.console.state.actions import UseAccount, UseRouter
from gui.console.state.intents import DismissRefusal
from gui.console.state.views import BannerView, ButtonView, ConnectView, RefusalView, RouterView
from gui.console.texts import Texts
from gui.window.widgets.controls import (
    NO_MARGINS,
    IntentButton,
    Panel,
    Sheet,
    in_column,
    in_row,
    label,
    named,
    plain_button,
    set_role,
    show_each,
)
from gui.window.widgets.files import FilePanel

WIDTH_PX = 290
BUTTONS = 4
"""Largest number of buttons of a banner."""


class Banner(Panel):
    """A sentence and buttons for the next step; hidden while there is nothing to do."""

    def __init__(self) -> None:
        super().__init__("notice")
        self.text = label(role="title", wrap=True)
        # All now: Tab reaches widgets in the order of their creation.
        self.buttons = [self.button(main=not number) for number in range(BUTTONS)]
        in_row((self.text, 1), *self.buttons, margins=(10, 4, 6, 4), inside=self)
        self.hide()

    def show_view(self, view: BannerView | None) -> None:
        """Show the banner, or hide it."""
        if view is not None:
            self.text.setText(view.text)
            for button, shown in zip_longest(self.buttons, view.buttons):
                button.show_view(shown)
        self.setVisible(view is not None)


class TroubleNotice(Panel):
    """A line below the panels, until the user closes it."""

    def __init__(self, texts: Texts) -> None:
        super().__init__("notice")
        self.text = label(wrap=True)
        self.close_button = plain_button(texts("label.dismiss"), texts("tip.dismiss"))
        self.close_button.clicked.connect(self.hide)
        in_row((self.text, 1), self.close_button, margins=(10, 4, 6, 4), inside=self)
        self.hide()

    def show_text(self, text: str) -> None:
        """Show an error."""
        self.text.setText(f"✕ {text}")
        self.setAccessibleName(text)
        self.show()


class RefusalNotice(Panel):
    """A frame in the lower left corner of the picture: it covers no control, and none moves."""

    def __init__(self, texts: Texts, parent: QWidget) -> None:
        super().__init__("notice", parent)
        self.text = label(wrap=True)
        self.alternative = self.button(main=True)
        self.dismiss = plain_button(texts("label.dismiss"), texts("tip.dismiss"))
        self.dismiss.clicked.connect(lambda: self.intent.emit(DismissRefusal()))
        buttons = in_row((self.alternative, 1), self.dismiss)
        in_column(self.text, buttons, margins=(10, 8, 10, 8), inside=self)
        self.hide()

    def show_over(self, picture: QRect, view: RefusalView | None) -> None:
        """Show the refusal in the corner of this part of the parent, or hide it."""
        if view is not None:
            self.text.setText(f"✕ {view.text}")
            self.setAccessibleName(view.text)
            self.alternative.show_view(view.alternative)
            width = max(WIDTH_PX, self.minimumSizeHint().width())
            height = self.heightForWidth(width)
            self.setGeometry(picture.left(), max(0, picture.bottom() + 1 - height), width, height)
            if self.isHidden():
                self.raise_()
        self.setVisible(view is not None)


SHEET_PX = 900
GAP_PX = 28
"""Space between router and hardware, which stand side by side: a low window has no room for one below the other."""


class RouterPanel(FilePanel):
    """The address of the router, whether it answers, and the account."""

    def __init__(self, texts: Texts) -> None:
        super().__init__(texts)
        self._address: str | None = None
        self.address = named(QLineEdit(), texts("label.router_address"), texts("tip.router_address"))
        self.use, self.join = IntentButton(), IntentButton()
        self.state, self.account = label(wrap=True), label(wrap=True)
        title = label(texts("label.router"), "title")
        first = in_row((self.address, 1), self.use)
        last = in_row((self.account, 1), self.join)
        in_column(title, first, self.state, last, None, gap=6, margins=NO_MARGINS, inside=self)
        self.address.returnPressed.connect(self._use)
        self.use.intent.connect(self._use)
        self.join.intent.connect(self._choose)

    def show_view(self, view: RouterView) -> None:
        """Show the present router; keep an address that the user is typing."""
        if view.address != self._address:
            self._address = view.address
            self.address.setText(view.address)
            self.address.setCursorPosition(0)
        self.state.setText(view.text)
        self.state.setToolTip(view.details)
        set_role(self.state, "role", "" if view.good is None else "good" if view.good else "bad")
        self.account.setText(view.account)
        self.use.show_view(view.use)
        self.join.show_view(view.join)

    def _use(self) -> None:
        if self.use.isEnabled():
            self.intent.emit(UseRouter(self.address.text()))

    def _choose(self) -> None:
        self.choose_file(self.join.text(), QFileDialog.AcceptMode.AcceptOpen, "toml", UseAccount)


class ConnectSheet(Sheet):
    """Router, account and hardware."""

    def __init__(self, texts: Texts, parent: QWidget) -> None:
        super().__init__(texts("connect.title"), parent, SHEET_PX)
        self.router, self.text = RouterPanel(texts), label(wrap=True)
        self.reports(self.router.intent)
        self.ports: list[IntentButton] = []
        self._list = in_column(gap=6)
        self.again, self.close_button = self.button(), self.button()
        title = label(texts("label.hw"), "title")
        hardware = in_column(title, self.text, self._list, None, gap=6)
        columns = in_row((self.router, 1), (hardware, 1), gap=GAP_PX)
        buttons = in_row(self.again, None, self.close_button)
        in_column(columns, buttons, gap=12, margins=(20, 14, 20, 14), inside=self)

    def _port(self, _view: ButtonView) -> IntentButton:
        button = self.button()
        button.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self._list.addWidget(button)
        return button

    def show_view(self, view: ConnectView | None) -> None:
        """Show the sheet, or hide it."""
        if view is None:
            self.hide()
            return
        self.router.show_view(view.router)
        self.text.setText(view.text)
        self.text.setToolTip(view.details)
        show_each(view.ports, self.ports, self._port)
        self.again.show_view(view.again if view.ports else None)
        self.close_button.show_view(view.close)
        self.appear(self.close_button)
