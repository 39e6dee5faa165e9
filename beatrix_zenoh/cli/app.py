"""`beatrix`: the entry point. It imports almost nothing at the top, so that `main` handles Ctrl-C during imports."""

from __future__ import annotations

import sys
from collections.abc import Callable


def main() -> None:
    """Run the command line of this process, and raise SystemExit with its exit code."""
    process(lambda: run(sys.argv[1:]))


def process(work: Callable[[], int]) -> None:
    """Run `work`, the whole task of this process; raise SystemExit with its exit code.

    The exit code is 130 after Ctrl-C, and FAULT after an exception, whose traceback is printed.
    """
    try:
        code = work()
        from beatrix_zenoh.shutdown import ignore_signals

        ignore_signals()  # so that a signal cannot change the exit code now that the work is done
    except KeyboardInterrupt:
        code = 130  # the exit code that shells use for Ctrl-C
    except Exception as error:  # noqa: BLE001 - prints the traceback, as Python would before it ends with exit code 1
        from beatrix_zenoh import hiding

        code = 1
        if why := hiding.cause(error):
            sys.stderr.write(f"{why}\n")
        else:
            import traceback

            from beatrix_zenoh.shutdown import FAULT

            traceback.print_exc()
            code = FAULT
    sys.exit(code)


def run(words: list[str]) -> int:
    """Run `beatrix` with these words and return the exit code."""
    try:
        from beatrix_zenoh.cli import run as runner
        from beatrix_zenoh.cli.verbs import application

        app = application(words)
    except (ImportError, AttributeError) as error:
        from beatrix_zenoh import hiding

        lacking = (
            f"needs {error.name}, which is not installed" if isinstance(error, ModuleNotFoundError) else ""
        )
        text = f"The command line {lacking or f'cannot be loaded: {error}'}."
        install = 'Run `pip install ".[cli]"` in the folder of BEATRIX.'
        sys.stderr.write((hiding.cause(error) or f"{text} {install}") + "\n")
        return 1
    return runner.run(app, words, "beatrix")
