"""Ends with code 0 if Qt can open a window on Linux; a process of its own, because Qt crashes if it cannot."""

from __future__ import annotations

import resource

from PyQt5.QtGui import QGuiApplication

if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    QGuiApplication([])
