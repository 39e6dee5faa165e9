"""`python -m beatrix_zenoh.cli.child …` is `beatrix …` for as long as whoever started it lives.

The parent holds the other end of standard input and writes nothing: when it has gone, however it
ended, reading returns and this process ends itself as on SIGTERM.
"""

from __future__ import annotations

import os
import signal
import threading

from beatrix_zenoh.cli.app import main

STDIN = 0


def watch_parent() -> None:
    """Return when the parent has gone, having asked this process to end."""
    while os.read(STDIN, 1):
        pass
    os.kill(os.getpid(), signal.SIGTERM)


if __name__ == "__main__":
    threading.Thread(target=watch_parent, name="beatrix-parent", daemon=True).start()
    main()
