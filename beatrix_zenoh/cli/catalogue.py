"""The verbs of `beatrix`, and the application made of them."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from typing import Annotated

import typer

from beatrix_zenoh.cli.verb import say

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
    "stop": "stop",
    "doctor": "doctor",
    "flash": "serving",
}
"""Verb and the file it is in, in the order of the help."""
PASS_THROUGH = {"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}
"""For verbs whose options only their process knows."""
PROCESSES = ("sim", "hw", "flash")
SETTINGS: dict[str, dict[str, object]] = {
    **dict.fromkeys(PROCESSES, PASS_THROUGH),
    "move": {"ignore_unknown_options": True},  # else -10 is an option
}
HELP = """BEATRIX, the humanoid head: simulation, robot, or both. All angles are degrees.

`beatrix VERB --help` explains a verb. Exit codes: 0 done, 1 refused or failed, 2 wrong usage, 3 nobody answered, 4 timed out,
130 ended by Ctrl-C, 141 the reader of its output has gone.
"""


def tell_version(asked: bool) -> None:
    """Which version is installed; ends."""
    if asked:
        from beatrix_zenoh.cli.checks import DISTRIBUTION, version

        say(f"beatrix {version(DISTRIBUTION) or 'from its sources, not installed'}")
        raise typer.Exit


def application(words: Sequence[str]) -> typer.Typer:
    """With the verb these words begin with, and nothing the others import; with all of them if it is none."""
    app = typer.Typer(
        help=HELP,
        add_completion=False,
        rich_markup_mode=None,  # rich would cost a one-shot verb 0.1 s
        no_args_is_help=True,
    )

    @app.callback(help=HELP)
    def beatrix(
        _version: Annotated[
            bool,
            typer.Option(
                "--version", is_eager=True, callback=tell_version, help="Print the version and end."
            ),
        ] = False,
    ) -> None:
        pass

    for name in words[:1] if words and words[0] in VERBS else VERBS:
        module = importlib.import_module(f"beatrix_zenoh.cli.{VERBS[name]}")
        app.command(name, context_settings=SETTINGS.get(name))(getattr(module, name))
    return app
