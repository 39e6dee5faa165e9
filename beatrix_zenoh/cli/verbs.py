"""The verbs of `beatrix`, and the typer application made of them."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from importlib import metadata
from typing import Annotated

import typer

from beatrix_zenoh.output import say

VERBS = {
    "demo": "demo.verbs",
    "up": "cli.serving",
    "router": "cli.serving",
    "sim": "cli.serving",
    "hw": "cli.serving",
    "gui": "cli.serving",
    "web": "cli.serving",
    "ls": "cli.listing",
    "info": "cli.listing",
    "echo": "cli.streams",
    "hz": "cli.streams",
    "top": "cli.listing",
    "graph": "cli.graph",
    "look": "cli.motions",
    "move": "cli.motions",
    "home": "cli.motions",
    "play": "cli.motions",
    "replay": "recording.verbs.replay",
    "compare": "recording.verbs.compare",
    "enable": "cli.commands",
    "disable": "cli.commands",
    "calibrate": "cli.commands",
    "stop": "cli.stop",
    "reset": "cli.commands",
    "follow": "cli.commands",
    "lease": "cli.commands",
    "freeze": "cli.commands",
    "unfreeze": "cli.commands",
    "limit": "cli.commands",
    "mute": "cli.commands",
    "unmute": "cli.commands",
    "record": "recording.verbs.record",
    "note": "recording.verbs.note",
    "export": "recording.verbs.export",
    "view": "recording.verbs.view",
    "doctor": "doctor.verbs",
    "flash": "cli.serving",
    "classroom": "classroom.verbs",
    "join": "classroom.verbs",
    "lesson": "lessons.verbs",
}
"""Each verb and its module in beatrix_zenoh, in the order of the help text."""
PASS_THROUGH = {"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}
"""Settings of verbs that pass their options to another program."""
PROCESSES = ("sim", "hw", "gui", "web", "flash")
SETTINGS: dict[str, dict[str, object]] = {
    **dict.fromkeys(PROCESSES, PASS_THROUGH),
    "move": {"ignore_unknown_options": True},  # so that -10 is an angle and not an option
}
HELP = """Control BEATRIX, the humanoid head: the simulation, the robot, or both. All angles are in degrees.

`beatrix VERB --help` explains a verb. Exit codes: 0 done, 1 refused or failed, 2 wrong usage, 3 no router, 4 timed out,
5 robot not online, 6 no such robot, 7 account refused, 8 request denied by the router, 9 robot lost, 10 node hangs,
130 ended by Ctrl-C, 141 pipe closed by the reader of the output.
"""


def print_version(given: bool) -> None:
    """Print the installed version and exit if the option is given."""
    if given:
        try:
            say(f"beatrix {metadata.version('beatrix-zenoh')}")
        except metadata.PackageNotFoundError:
            say("beatrix from its sources, not installed")
        raise typer.Exit


def application(words: Sequence[str]) -> typer.Typer:
    """Return the application with the verb that `words` begin with, or with all verbs if they begin with none.

    Only the modules of these verbs are imported.
    """
    app = typer.Typer(
        help=HELP,
        add_completion=False,
        rich_markup_mode=None,  # importing rich would delay every verb by 0.1 s
        no_args_is_help=True,
    )

    @app.callback(help=HELP)
    def beatrix(
        _version: Annotated[
            bool,
            typer.Option(
                "--version", is_eager=True, callback=print_version, help="Print the version and exit."
            ),
        ] = False,
    ) -> None:
        pass

    for name in words[:1] if words and words[0] in VERBS else VERBS:
        module = importlib.import_module(f"beatrix_zenoh.{VERBS[name]}")
        verb = getattr(module, name)
        if isinstance(verb, typer.Typer):
            app.add_typer(verb)
        else:
            app.command(name, context_settings=SETTINGS.get(name))(verb)
    return app
