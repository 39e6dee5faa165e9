"""The verbs of `beatrix`, and the typer application made of them."""

from __future__ import annotations

import ast
import importlib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Annotated

import typer

import beatrix_zenoh
from beatrix_zenoh.output import say

MODULES = {
    "demo.verbs": ("demo",),
    "cli.serving": ("up", "router", "sim", "hw", "gui", "web", "flash", "model"),
    "cli.listing": ("ls", "status", "info", "top"),
    "cli.streams": ("echo", "hz"),
    "cli.graph": ("graph",),
    "cli.motions": ("look", "move", "home", "play"),
    "cli.stop": ("stop",),
    "cli.commands": (
        *("enable", "disable", "calibrate", "reset", "follow"),
        *("lease", "freeze", "unfreeze", "limit", "mute", "unmute"),
    ),
    "recording.verbs.record": ("record",),
    "recording.verbs.note": ("note",),
    "recording.verbs.view": ("view",),
    "recording.verbs.export": ("export",),
    "recording.verbs.replay": ("replay",),
    "recording.verbs.compare": ("compare",),
    "doctor.verbs": ("doctor",),
    "cli.install": ("install",),
    "classroom.verbs": ("classroom", "join"),
    "lessons.verbs": ("lesson",),
}
"""The verbs of each module in beatrix_zenoh, in the order of the help text."""
VERBS = {verb: module for module, verbs in MODULES.items() for verb in verbs}
PASS_THROUGH = {"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}
"""Settings of verbs that pass their options to another program."""
PROCESSES = ("sim", "hw", "gui", "web", "flash", "model")
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
        from importlib import metadata  # it imports email, which would delay every verb

        try:
            say(f"beatrix {metadata.version('beatrix-zenoh')}")
        except metadata.PackageNotFoundError:
            say("beatrix from its sources, not installed")
        raise typer.Exit


def application(words: Sequence[str]) -> typer.Typer:
    """Return the application with the verb that `words` begin with; only its module is imported.

    If `words` name no verb, the application has all verbs for its help, and none of them is imported.
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

    if VERBS.keys().isdisjoint(words):
        for name in VERBS:
            app.command(name, help=summary(name), context_settings=SETTINGS.get(name))(lambda: None)
        return app
    for name in words[:1] if words[0] in VERBS else VERBS:
        verb = getattr(importlib.import_module(f"beatrix_zenoh.{VERBS[name]}"), name)
        if isinstance(verb, typer.Typer):
            app.add_typer(verb)
        else:
            app.command(name, context_settings=SETTINGS.get(name))(verb)
    return app


def summary(name: str) -> str:
    """Return the help of a verb from the source of its module: importing all modules takes three times as long."""
    for node in parsed(VERBS[name]).body:
        match node:
            case ast.FunctionDef(name=defined) if defined == name:
                return ast.get_docstring(node) or ""
            case ast.Assign(targets=[ast.Name(id=defined)], value=ast.Call(keywords=given)) if (
                defined == name
            ):
                return str(next(ast.literal_eval(one.value) for one in given if one.arg == "help"))
    raise LookupError(f"{VERBS[name]} has no verb {name}")


@cache
def parsed(module: str) -> ast.Module:
    """Return the syntax tree of a module of beatrix_zenoh."""
    path = Path(beatrix_zenoh.__file__).parent / f"{module.replace('.', '/')}.py"
    return ast.parse(path.read_bytes())
