"""Draw the window in its main states, themes and sizes: `python tools/window_pictures.py FOLDER`. Needs no display.

With --pages it makes only the pictures of the documentation, docs/images/window-*.png, in FOLDER. With --screen it
shows the window on the display and draws the whole screen, with the frame of the window manager.
"""

from __future__ import annotations

import argparse
import os
import sys
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/support"))

from gui_views import STATES, example
from PIL import Image
from PyQt5 import sip
from PyQt5.QtTest import QTest
from PyQt5.QtWidgets import QApplication, QMainWindow

from gui.console.state.intents import Theme
from gui.console.state.views import View
from gui.console.texts import Texts
from gui.window.panels import Panels
from gui.window.run import qt_application, show
from gui.window.theme import apply_theme, style_of

FRAMED_MS = 300
"""Time in which the window manager draws a frame."""
SIZES = ((1366, 768), (1024, 768), (1024, 600))
PAGES = {
    "simple": (Theme.LIGHT, (1366, 768)),
    "preview": (Theme.DARK, (1366, 768)),
    "refusal": (Theme.DARK, (1366, 768)),
    "class": (Theme.LIGHT, (1024, 600)),
}
"""Theme and size of the pictures in docs/images, by state."""
PARTS = {"class-full": ("robots", "lessons", "projector")}
"""By state: parts of the window of which each has a picture of its own."""


def draw(view: View, size: tuple[int, int] | None, file: Path, part: str) -> None:
    """Save a picture of the window that shows a view, and print the size of the window and the smallest one without scroll bars.

    size: of the window; None: the window has the size that it chooses, and the picture is that of the screen.
    """
    window = QMainWindow()
    panels = Panels(Texts(view.choices.language))
    window.setCentralWidget(panels)
    apply_theme(window, style_of(view.choices.theme))
    screen = QApplication.primaryScreen()
    if size is None:
        show(window, screen.availableGeometry().size())
        QTest.qWait(FRAMED_MS)
    else:
        window.resize(*size)
        window.show()
    panels.show_theme(view.choices.theme)
    panels.show_view(view)
    panels.header.setVisible(part != "projector")
    panels.class_page.show_large(on=part == "projector")
    panels.class_page.tabs.setCurrentIndex(int(part == "lessons"))
    for _ in range(5):
        QApplication.processEvents()
    panels.show_view(view)
    QApplication.processEvents()
    hint = panels.area.widget().minimumSizeHint()
    print(
        file.name, f"{window.width()}x{window.height()}", f"needs {hint.width()}x{hint.height()} above STOP"
    )
    (window.grab() if size is not None else screen.grabWindow(sip.voidptr(0))).save(str(file))
    window.close()


def draw_pages(folder: Path) -> None:
    """Save the pictures of the documentation, with so few colours that they are small."""
    for state, (theme, size) in PAGES.items():
        file = folder / f"window-{state}.png"
        draw(replace(example(state, theme, "en"), guide=None), size, file, "")
        picture = Image.open(file).convert("RGB")
        picture.quantize(256, Image.Quantize.MEDIANCUT, kmeans=3, dither=Image.Dither.NONE).save(
            file, optimize=True
        )


def main() -> int:
    """Draw all states, or those that the options choose."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--language", default="en")
    parser.add_argument("--screen", action="store_true", help="draw the whole screen of a display")
    parser.add_argument("--pages", action="store_true", help="draw the pictures of the documentation")
    parser.add_argument("--only", default="", help="draw only states whose name contains this text")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    application = qt_application()
    if options.pages:
        draw_pages(options.folder)
    for state in () if options.pages else STATES:
        if options.only not in state:
            continue
        for theme in Theme:
            for size in (None,) if options.screen else SIZES:
                for part in PARTS.get(state, ("",)):
                    name = "-".join(filter(None, ("window", state, part, theme)))
                    shown = "screen" if size is None else f"{size[0]}x{size[1]}"
                    file = options.folder / f"{name}-{shown}-{options.language}.png"
                    view = replace(example(state, theme, options.language), guide=None)
                    draw(view, size, file, part)
    del application
    return 0


if __name__ == "__main__":
    sys.exit(main())
