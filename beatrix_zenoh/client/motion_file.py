"""Motion files: CSV with one point per line, a time and the angles of the head or the arms."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple, Self

from beatrix_zenoh import files
from beatrix_zenoh.client.degrees import DAY_S, ArmAngles, HeadAngles
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage, quoted, wrong_usage

LONGEST_FILE: Final = 1 << 23
"""Largest size of a file (bytes): four hours at 20 points per second."""
TIME, SPEED, FIGURE = "t_s", "speed_deg_s", "figure"
HEAD: Final = ("yaw_deg", "pitch_deg", "roll_deg")
ARMS: Final = ("short_deg", "middle_deg", "long_deg")
COLUMNS: Final = (TIME, *HEAD, *ARMS, SPEED, FIGURE)
SEPARATORS: Final = (";", "\t", ",")
COMMENT: Final = ("#", '"#')
"""First characters of a comment; a spreadsheet quotes comments that contain a comma."""
LINE_END: Final = re.compile("\r\n|\r|\n")
NUMBER: Final = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
TYPOGRAPHY: Final = str.maketrans({",": ".", "\N{MINUS SIGN}": "-", "\N{EN DASH}": "-"})
"""Decimal comma, and the minus signs of word processors. A cell with a comma is quoted, or the separator is another."""
FORM: Final = "docs/how-to/motion-files.md explains the format."
Place = HeadAngles | ArmAngles


class Point(NamedTuple):
    """One line of a motion file: a time and angles."""

    line: int
    """line number, from 1"""
    t: float
    """time from the start (s)"""
    place: Place
    """angles (deg)"""
    speed: float | None = None
    """deg/s; None: the speed of the previous pose, or the file is a path, which has no speeds"""
    figure: str = ""
    """name of the gesture that begins here; empty: unchanged"""


@dataclass(frozen=True)
class MotionFile:
    """The contents of a file: points in the order of their times."""

    source: str
    """the name in error messages"""
    points: tuple[Point, ...]
    with_speed: bool
    """whether the file has a column of speeds; a choreography has one, a path does not"""


class WrongLine(WrongUsage):
    """A line of a motion file that cannot be used."""

    def __init__(self, line: int, message: str) -> None:
        """`line` counts from 1."""
        super().__init__(Reason.BAD_VALUE, message)
        self.line = line

    def __reduce__(self) -> tuple[type[Self], tuple[int, str]]:  # type: ignore[override]
        return type(self), (self.line, self.message)


def read(path: Path) -> MotionFile:
    """Read a motion file.

    Raises:
        OSError: the file cannot be read.
        WrongUsage: BAD_VALUE; the message names the cause and, if there is one, the wrong line.
    """
    return parse(files.text(path, LONGEST_FILE, "CSV"), str(path))


def parse(text: str, source: str) -> MotionFile:
    """Read a motion from its text; `source` is its name in error messages.

    Raises:
        WrongUsage: BAD_VALUE; the message names the wrong line and the allowed values.
    """
    lines = [(number, line) for number, line in enumerate(LINE_END.split(text), 1) if counts(line)]
    if not lines:
        raise wrong_usage(
            f"{source}: begin with the names of the columns, {','.join((TIME, *HEAD))}. {FORM}",
        )
    (number, first), *rest = lines
    separator = next((each for each in SEPARATORS if each in first), ",")
    with refusing(source, number):
        names = header(cells(first, separator))
    points: list[Point] = []
    for number, line in rest:
        with refusing(source, number):
            point = point_of(number, names, cells(line, separator))
            check_order(points[-1].t if points else 0.0, point.t)
        points.append(point)
    if not points:
        raise wrong_usage(f"{source}: there are no points: add lines such as 0.5,10,-5,0. {FORM}")
    return MotionFile(source, tuple(points), SPEED in names)


@contextmanager
def refusing(source: str, line: int) -> Iterator[None]:
    """Convert ValueError and csv.Error to WrongUsage with a message that names file and line."""
    try:
        yield
    except (ValueError, csv.Error) as error:
        raise WrongLine(line, f"{source}, line {line}: {error}. {FORM}") from error


def counts(line: str) -> bool:
    """Return whether the line is neither a comment nor empty."""
    return bool(line.strip(" \t,;")) and not line.startswith(COMMENT)


def check_order(before: float, t: float) -> None:
    """Raise ValueError if a time (s) is earlier than the time of the line before."""
    if t < before:
        raise ValueError(f"{TIME} is {t:g}, earlier than in the line before ({before:g})")


def cells(line: str, separator: str) -> list[str]:
    """Return the cells of one line, stripped; raises csv.Error for an open quote."""
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, strict=True))]


def header(names: list[str]) -> list[str]:
    """Return the column names without empty ones at the end; raises ValueError for unknown, double or missing ones."""
    while names and not names[-1]:
        names.pop()
    for name in names:
        if name not in COLUMNS:
            raise ValueError(f"{quoted(name)} is not a column; choose from {', '.join(COLUMNS)}")
        if names.count(name) > 1:
            raise ValueError(f"the column {name} occurs {names.count(name)} times")
    triples = [triple for triple in (HEAD, ARMS) if any(name in names for name in triple)]
    missing = [name for triple in triples or [HEAD] for name in triple if name not in names]
    if TIME not in names or missing:
        missing = [TIME] * (TIME not in names) + missing
        raise ValueError(f"the columns lack {', '.join(missing)}")
    return names


def point_of(line: int, names: Sequence[str], given: Sequence[str]) -> Point:
    """Return the point of one line; raises ValueError with a message that names the wrong column."""
    if any(given[len(names) :]):
        raise ValueError(f"it has {len(given)} cells, but the file has {len(names)} columns")
    row = dict(zip(names, [*given, *[""] * len(names)], strict=False))
    t = number_of(TIME, row[TIME])
    if not 0 <= t <= DAY_S:
        raise ValueError(f"{TIME} is {t:g}: give a number of seconds from 0 to {DAY_S:.0f}")
    filled = [triple for triple in (HEAD, ARMS) if any(row.get(name) for name in triple)]
    if len(filled) != 1:
        raise ValueError("give the angles of the head or those of the arms" + ", not both" * bool(filled))
    angles = [number_of(name, row[name]) for name in filled[0]]
    place = HeadAngles(*angles) if filled[0] is HEAD else ArmAngles(*angles)
    speed = None
    if row.get(SPEED):
        speed = number_of(SPEED, row[SPEED])
        if speed <= 0:
            raise ValueError(f"{SPEED} is {speed:g}: give a number of degrees/s above 0")
    return Point(line, t, place, speed, row.get(FIGURE, ""))


def number_of(name: str, text: str) -> float:
    """Convert a cell to a number; raises ValueError that names the column."""
    figures = text.translate(TYPOGRAPHY)
    if not NUMBER.fullmatch(figures):
        raise ValueError(f"{name} is {quoted(text) if text else 'empty'}: give a number")
    number = float(figures)
    if not (math.isfinite(number) and codec.fits(number)):
        raise ValueError(f"{name} is {number:g}: numbers up to 3.4e38 are allowed")
    return number


def lines_of(places: Iterable[tuple[float, Place]], comments: Sequence[str] = ()) -> Iterable[str]:
    """Yield the lines of a path, with line feeds: times to 1 ms; places to 0.001 deg, all of the head or of the arms."""
    for comment in comments:
        yield f"# {comment}\n"
    for number, (t, place) in enumerate(places):
        if number == 0:
            yield ",".join((TIME, *(HEAD if isinstance(place, HeadAngles) else ARMS))) + "\n"
        yield ",".join(f"{value:z.3f}" for value in (t, *place)) + "\n"
