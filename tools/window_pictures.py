"""Draw the window in its main states, themes and sizes: `python tools/window_pictures.py FOLDER`. Needs no display."""

from __future__ import annotations

import argparse
import os
import sys
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests/support"))

from gui_views import STATES, example
from PyQt5.QtWidgets import QApplication, QMainWindow

from gui.console.state.intents import Theme
from gui.console.state.views import View
from gui.console.texts import Texts
from gui.window.panels import Panels
from gui.window.theme import apply_theme, style_of

SIZES = ((1366, 768), (1024, 768), (1024, 600))


PARTS = {"class-full": ("robots", "lessons", "projector")}
"""By state: parts of the window of which each has a picture of its own."""


def draw(view: View, size: tuple[int, int], file: Path, part: str) -> None:
    """Save a picture of the window that shows a view, and print the present and the smallest size of the window."""
    window = QMainWindow()
    panels = Panels(Texts(view.language))
    window.setCentralWidget(panels)
    window.setMinimumSize(1024, 560)
    apply_theme(window, style_of(view.theme))
    window.resize(*size)
    window.show()
    panels.show_theme(view.theme)
    panels.show_view(view)
    panels.class_page.tabs.setCurrentIndex(int(part == "lessons"))
    for shown in (panels.header, panels.pages):
        shown.setVisible(part != "projector")
    panels.projector.setVisible(part == "projector")
    for _ in range(5):
        QApplication.processEvents()
    panels.show_view(view)
    panels.refusal.place()
    QApplication.processEvents()
    hint = window.minimumSizeHint()
    print(file.name, f"{window.width()}x{window.height()}", f"needs {hint.width()}x{hint.height()}")
    window.grab().save(str(file))
    window.close()


def main() -> int:
    """Draw all states, or those that the options choose."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--language", default="en")
    parser.add_argument("--only", default="", help="draw only states whose name contains this text")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    application = QApplication(sys.argv[:1])
    application.setStyle("Fusion")
    for state in STATES:
        if options.only not in state:
            continue
        for theme in Theme:
            for size in SIZES:
                for part in PARTS.get(state, ("",)):
                    name = "-".join(filter(None, ("window", state, part, theme)))
                    file = options.folder / f"{name}-{size[0]}x{size[1]}-{options.language}.png"
                    view = replace(example(state, theme, options.language), guide=None)
                    draw(view, size, file, part)
    del application
    return 0


if __name__ == "__main__":
    sys.exit(main())
