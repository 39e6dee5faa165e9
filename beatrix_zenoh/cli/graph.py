"""`beatrix graph`: the programs that are connected to a router, and their keys, as text or as a drawing."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Annotated

import typer

from beatrix_zenoh.cli import network
from beatrix_zenoh.cli.network import Program, short
from beatrix_zenoh.cli.options import Connect, Json, Who
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.output import print_json, say
from beatrix_zenoh.settings import resolve

LINE_PX, PAD_PX, BOX_PX, GAP_PX = 18, 12, 330, 26
"""Height of a line of text, margin inside a box, width of a box, space between boxes."""
MIDDLE_PX = 300
"""Space between nodes, to the left, and clients, to the right, for the arrows."""
COLOURS = {"watch": "#245", "ask": "#a40"}
"""Colours of the arrows from a node to a program that watches it, and from a program to a node that it asks."""
UNDESCRIBED = "does not describe itself: it hangs, or has another version"


def graph(
    svg: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a drawing (SVG) to this file.")
    ] = None,
    connect: Connect = None,
    who: Who = None,
    as_json: Json = False,
) -> None:
    """Show the programs at the router, and which watch or ask which.

    Requests count for one minute. Programs describe themselves. A Zenoh program that does not use this library is not listed.
    """
    with Client(resolve(None, connect, who)) as client:
        programs, endpoint = network.read(client), client.bus.endpoint
    if svg is not None:
        svg.write_text(drawing(programs, endpoint), encoding="utf-8")
    if as_json:
        print_json(
            {"result": True, "endpoint": endpoint, "programs": [as_row(program) for program in programs]}
        )
    elif svg is not None:
        say(f"The drawing is in {svg}.")
    else:
        say(text(programs, endpoint))


def as_row(program: Program) -> dict[str, object]:
    """Return the fields of a program, for JSON output."""
    return {
        "title": program.title,
        "described": program.described,
        "serves": sorted(program.serves),
        "publishes": sorted(program.publishes),
        "subscribes": sorted(program.subscribes),
        "asks": sorted(program.asks),
    }


def lines(program: Program, nodes: Sequence[Program]) -> list[str]:
    """Return a line for each key that a node publishes or serves, or for each node that a client watches or asks."""
    if not program.described:
        return [UNDESCRIBED]
    if program.robot is not None:
        serves = sorted({short(key) for key in program.serves} - {short(key) for key in program.publishes})
        return [
            *(f"publishes {short(key)}" for key in sorted(program.publishes)),
            *(f"answers {key}" for key in serves),
        ]
    rows = [f"watches {node.title}: {', '.join(found)}" for node in nodes if (found := program.watches(node))]
    rows += [f"asks {node.title}: {', '.join(found)}" for node in nodes if (found := program.queries(node))]
    return rows or ["watches and asks no robot"]


def text(programs: Sequence[Program], endpoint: str) -> str:
    """Return a text for a terminal: all programs, with their keys."""
    nodes = [program for program in programs if program.robot is not None]
    listed = ("\n  ".join([program.title, *lines(program, nodes)]) for program in programs)
    return "\n\n".join([f"router {endpoint}", *listed])


def drawing(programs: Sequence[Program], endpoint: str) -> str:
    """Return an SVG: nodes to the left, clients to the right, arrows to who watches a node and from who asks it."""
    nodes = [program for program in programs if program.robot is not None]
    clients = [program for program in programs if program.robot is None]
    left, left_end = _column(nodes, nodes, PAD_PX)
    right, right_end = _column(clients, nodes, PAD_PX + BOX_PX + MIDDLE_PX)
    places = left | right
    width, height = 2 * (PAD_PX + BOX_PX) + MIDDLE_PX, max(left_end, right_end)
    shapes = [_box(program, nodes, *places[program.title]) for program in programs]
    arrows = []
    for client in clients:
        for node in nodes:
            (x1, y1), (x2, y2) = places[node.title], places[client.title]
            watch, ask = (x1 + BOX_PX, y1, x2, y2), (x2, y2 + LINE_PX, x1 + BOX_PX, y1 + LINE_PX)
            arrows += _arrow(watch, client.watches(node), "watch")
            arrows += _arrow(ask, client.queries(node), "ask")
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" font-size="13">',
            *(
                f'<defs><marker id="{kind}" markerWidth="9" markerHeight="8" refX="8" refY="4" orient="auto">'
                f'<path d="M0,0 L9,4 L0,8 Z" fill="{colour}"/></marker></defs>'
                for kind, colour in COLOURS.items()
            ),
            f'<rect width="{width}" height="{height}" fill="white"/>',
            f'<text x="{PAD_PX}" y="{LINE_PX}" font-weight="bold">router {escape(endpoint)}</text>',
            *arrows,
            *shapes,
            "</svg>\n",
        ]
    )


def _column(
    programs: Sequence[Program], nodes: Sequence[Program], x: int
) -> tuple[dict[str, tuple[int, int]], int]:
    """Return the position of each program's box, and the lower end of the column (px)."""
    places, y = {}, LINE_PX + PAD_PX
    for program in programs:
        places[program.title] = x, y
        y += _height(program, nodes) + GAP_PX
    return places, y


def _height(program: Program, nodes: Sequence[Program]) -> int:
    return (len(lines(program, nodes)) + 1) * LINE_PX + PAD_PX


def _box(program: Program, nodes: Sequence[Program], x: int, y: int) -> str:
    colour = "#e8f1fb" if program.robot is not None else "#f6f2e6"
    rows = [program.title, *lines(program, nodes)]
    texts = [
        f'<text x="{x + PAD_PX}" y="{y + LINE_PX * (number + 1)}"{" font-weight=" + chr(34) + "bold" + chr(34) if not number else ""}>'
        f"{escape(row)}</text>"
        for number, row in enumerate(rows)
    ]
    frame = f'<rect x="{x}" y="{y}" width="{BOX_PX}" height="{_height(program, nodes)}" rx="6" fill="{colour}" stroke="#245"/>'
    return "\n".join([frame, *texts])


def _arrow(line: tuple[int, int, int, int], names: Sequence[str], kind: str) -> list[str]:
    """Return the shapes of an arrow, one line below the upper edges of its boxes, with a label; none without names."""
    if not names:
        return []
    x1, y1, x2, y2 = line[0], line[1] + LINE_PX, line[2], line[3] + LINE_PX
    label = f"{len(names)} keys" if len(names) > 1 else names[0]
    return [
        f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" stroke="{COLOURS[kind]}" marker-end="url(#{kind})"/>',
        f'<text x="{(x1 + x2) // 2}" y="{(y1 + y2) // 2 - 5}" text-anchor="middle" fill="{COLOURS[kind]}">{escape(label)}</text>',
    ]
