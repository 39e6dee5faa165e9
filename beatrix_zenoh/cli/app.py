"""`beatrix`: finds the verb, imports only what it needs, and ends."""

from __future__ import annotations

import importlib
import io
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import typer

VERBS = {
    "demo": "demo",
    "up": "up",
    "router": "serving",
    "sim": "serving",
    "hw": "serving",
    "ls": "listing",
    "info": "listing",
    "echo": "streams",
    "hz": "streams",
    "top": "top",
    "look": "motions",
    "move": "motions",
    "home": "motions",
    "enable": "commands",
    "disable": "commands",
    "calibrate": "commands",
    "stop": "commands",
    "doctor": "doctor",
}
"""Verb and the file it is in, in the order of the help."""
PASS_THROUGH = {"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}
"""For verbs whose options only their process knows."""
PROCESSES = ("sim", "hw")
SETTINGS: dict[str, dict[str, object]] = {
    **dict.fromkeys(PROCESSES, PASS_THROUGH),
    "move": {"ignore_unknown_options": True},  # else -10 is an option
}
HELP = """BEATRIX, the humanoid head: simulation, robot, or both. All angles are degrees.

`beatrix VERB --help` explains a verb. Exit codes: 0 done, 1 refused or failed, 2 wrong usage, 3 nobody answered, 4 timed out.
"""


def build(verbs: Sequence[str]) -> typer.Typer:
    """The application with these verbs."""
    import typer

    app = typer.Typer(
        help=HELP,
        add_completion=False,
        rich_markup_mode=None,  # rich would cost a one-shot verb 0.1 s
        pretty_exceptions_enable=False,
        no_args_is_help=True,
    )

    @app.callback(help=HELP)
    def beatrix() -> None:
        pass

    for name in verbs:
        module = importlib.import_module(f"beatrix_zenoh.cli.{VERBS[name]}")
        app.command(name, context_settings=SETTINGS.get(name))(getattr(module, name))
    return app


def main(arguments: Sequence[str] | None = None) -> None:
    """Run `beatrix` with these arguments, default those of the process; ends with SystemExit."""
    words = sys.argv[1:] if arguments is None else list(arguments)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without a degree sign is no reason to fail
    try:
        app = build(words[:1] if words and words[0] in VERBS else tuple(VERBS))
    except ModuleNotFoundError as error:
        if error.name not in ("typer", "rich"):
            raise
        sys.exit(
            f'The command line needs {error.name}, which is not installed: pip install ".[cli]" in the folder of BEATRIX'
        )
    except KeyboardInterrupt:
        sys.exit(130)
    app(args=words, prog_name="beatrix")
