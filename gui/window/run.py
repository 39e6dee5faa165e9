"""The process of the window: Qt, the bridge from the link's threads, saved choices, and the end."""

from __future__ import annotations

import contextlib
import logging
import sys
import threading
from collections.abc import Callable, Hashable, Iterator

import msgspec
from PyQt5.QtCore import QObject, QSize, Qt, QTimer, pyqtSignal
from PyQt5.QtGui import QGuiApplication
from PyQt5.QtWidgets import QApplication, QWidget

from beatrix_zenoh.output import say
from beatrix_zenoh.settings import Settings
from beatrix_zenoh.shutdown import Shutdown, ignore_signals
from gui.console.link import Link
from gui.console.state import saved
from gui.console.state.intents import Theme
from gui.console.state.saved import Saved
from gui.console.state.state import State
from gui.window.window import Window

SAVE_MS = 1000
"""Period of saving changed choices."""
SIGNAL_MS = 100
"""Period of checking for Ctrl-C: Python runs signal handlers only between Python instructions, and Qt's loop executes
none."""
SIZE = (1366, 768)
FRAME = QSize(16, 56)
"""Largest usual frame of a window, title bar included, in pixels before scaling; GNOME's title bar has 47."""
logger = logging.getLogger("beatrix.window")


class Autosave:
    """Writes the changes of this window, and keeps those that other windows have saved in the meantime."""

    def __init__(self, state: State) -> None:
        """Treat the present choices as already saved."""
        self._state, self._file = state, saved.path()
        self._kept: Saved = state.saved

    def save_changes(self) -> None:
        """Write the changes since the last call, if any; log a failure, which must not end the window."""
        mine = self._state.saved
        if mine == self._kept:
            return
        before, self._kept = self._kept, mine
        try:
            saved.save(self._file, saved.merged(before, mine, saved.load(self._file)))
        except OSError as error:
            logger.warning("The choices of the window cannot be saved: %s.", error)


class Bridge(QObject):
    """Runs calls of other threads in the thread that created this object, which is Qt's thread.

    `post` queues every call. `post_latest` keeps only the newest call of a slot, for pictures: a slow window skips
    pictures and never falls behind.
    """

    _queued = pyqtSignal(object)

    def __init__(self) -> None:
        super().__init__()
        self._lock = threading.Lock()
        self._newest: dict[Hashable, Callable[[], None]] = {}
        self._closed = False
        self._queued.connect(self._run)  # a call from another thread is queued by Qt

    def post(self, call: Callable[[], None]) -> None:
        """Run `call` in Qt's thread; any thread may post. No call begins after `close`."""
        if not self._closed:
            self._queued.emit(call)

    def post_latest(self, slot: Hashable, call: Callable[[], None]) -> None:
        """Run `call` as `post` does, but replace a waiting call of the same slot."""
        with self._lock:
            waiting = slot in self._newest
            self._newest[slot] = call
        if not waiting:
            self.post(lambda: self._run_newest(slot))

    def _run_newest(self, slot: Hashable) -> None:
        with self._lock:
            call = self._newest.pop(slot)
        call()

    def _run(self, call: Callable[[], None]) -> None:
        if not self._closed:
            call()

    def close(self) -> None:
        """Drop the calls that wait, and all later ones."""
        self._closed = True


def run(settings: Settings, theme: Theme | None, language: str | None, *, name_given: bool) -> int:
    """Show the window until it is closed or a signal arrives; returns the exit code."""
    application, state, shutdown = qt_application(), chosen_state(theme, language), Shutdown()
    shutdown.handle_signals()
    autosave = Autosave(state)
    try:
        with linked_window(settings, state, name_given=name_given) as window:
            show(window, QGuiApplication.primaryScreen().availableGeometry().size())
            signals = QTimer()
            signals.timeout.connect(lambda: window.close() if shutdown.requested(0.0) else None)
            signals.start(SIGNAL_MS)
            saving = QTimer()
            saving.timeout.connect(autosave.save_changes)
            saving.start(SAVE_MS)
            say("ready window")
            application.exec()
            ignore_signals()
    finally:
        ignore_signals()
        autosave.save_changes()
    return 0


@contextlib.contextmanager
def linked_window(settings: Settings, state: State, *, name_given: bool) -> Iterator[Window]:
    """Yield a hidden window with a link that looks for the router; close the link at the end of the block."""
    bridge = Bridge()
    link = Link(  # reports nothing before the first action, and by then the window exists
        settings,
        lambda outcome: bridge.post(lambda: window.report(outcome)),
        lambda side, image: bridge.post_latest((side, image.eye), lambda: window.show_image(side, image)),
        name_given=name_given,
    )
    try:
        window = Window(link, state)
        with errors_shown(lambda text: bridge.post(lambda: window.show_error(text))):
            yield window
    finally:
        bridge.close()
        link.close()


def show(window: QWidget, room: QSize) -> None:
    """Show a window on a screen with this free area: maximized if it would not fit with its frame, which Qt cannot tell yet.

    The lower edge of the window, where STOP is, would be outside the screen otherwise.
    """
    free = room - FRAME
    window.resize(QSize(*SIZE).boundedTo(free))
    if window.size() == QSize(*SIZE):
        window.show()
    else:
        window.showMaximized()


def qt_application() -> QApplication:
    """Create Qt's application in the style that all themes are made for."""
    QApplication.setAttribute(Qt.ApplicationAttribute.AA_EnableHighDpiScaling)
    QApplication.setAttribute(Qt.ApplicationAttribute.AA_UseHighDpiPixmaps)
    application = QApplication(["beatrix"])
    application.setStyle("Fusion")
    return application


def chosen_state(theme: Theme | None, language: str | None) -> State:
    """Return a state with the saved choices; options of the command line take precedence."""
    kept = saved.load(saved.path())
    return State(msgspec.structs.replace(kept, theme=theme or kept.theme, language=language or kept.language))


@contextlib.contextmanager
def errors_shown(show: Callable[[str], None]) -> Iterator[None]:
    """Show and log unhandled errors of all threads in the block; PyQt alone would end the process with a core dump."""

    def report(error: BaseException | None) -> None:
        logger.error("unhandled error", exc_info=error)
        show(f"{type(error).__name__}: {error}")

    old = sys.excepthook, threading.excepthook
    sys.excepthook = lambda _kind, error, _trace: report(error)
    threading.excepthook = lambda arguments: report(arguments.exc_value)
    try:
        yield
    finally:
        sys.excepthook, threading.excepthook = old
