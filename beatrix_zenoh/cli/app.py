"""`beatrix`: the entry point. It imports almost nothing at the top, so that `main` handles Ctrl-C during imports."""

from __future__ import annotations

import sys

from beatrix_zenoh import hiding
from beatrix_zenoh.shutdown import INTERRUPTED, interrupted, process


def main() -> None:
    """Run the command line of this process, and raise SystemExit with its exit code."""
    process(lambda: run(sys.argv[1:]))


def run(words: list[str]) -> int:
    """Run `beatrix` with these words and return the exit code."""
    try:
        from beatrix_zenoh.cli.verbs import application
        from beatrix_zenoh.terminal import run as runner

        why = hiding.unfit(hiding.search_path()[0])
        if why and words[:1] != ["doctor"]:  # doctor lists it with its other findings
            sys.stderr.write(f"{why}\n")
            return 1
        app = application(words)
    except (ImportError, AttributeError) as error:
        if interrupted(error):
            return INTERRUPTED
        lacking = (
            f"needs {error.name}, which is not installed" if isinstance(error, ModuleNotFoundError) else ""
        )
        text = f"The command line {lacking or f'cannot be loaded: {error}'}."
        install = f'Run `{sys.executable} -m pip install "beatrix-zenoh[cli]"`.'
        sys.stderr.write((hiding.cause(error) or f"{text} {install}") + "\n")
        return 1
    return runner.run(app, words, "beatrix")
