"""Commands that the programs print can be pasted into a POSIX shell and into PowerShell."""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import pytest
from house import PACKAGES
from hypothesis import given
from hypothesis import strategies as st
from robots import ROOT

from beatrix_zenoh.output import typed
from beatrix_zenoh.processes import advice

POWERSHELL = re.compile(r"""[\w+:./][\w+:./-]*|--?[\w][\w.-]*|"[^"`$“”„\n]*"|'(?:[^'‘’‚‛]|'')*'""", re.ASCII)
"""A word that PowerShell passes on unchanged: plain, or between quotes that contain nothing it would replace."""
WORDS = {
    "lesson.rrd": "lesson.rrd",
    "my lesson.rrd": '"my lesson.rrd"',
    "Übung 3.rrd": '"Übung 3.rrd"',
    "tcp/[::1]:7447": '"tcp/[::1]:7447"',
    "tls/10.0.0.2:7447,tls/lab:7447": '"tls/10.0.0.2:7447,tls/lab:7447"',
    "30,20,10": '"30,20,10"',
    "-10.5": "-10.5",
    "price $5.rrd": "'price $5.rrd'",
    "wow!.rrd": "'wow!.rrd'",
    "it's.rrd": '"it\'s.rrd"',
    "~/a.rrd": '"~/a.rrd"',
    "#1.rrd": '"#1.rrd"',
    "virtual:": "virtual:",
    r"\\server\a b.rrd": r"'\\server\a b.rrd'",
}


@pytest.mark.parametrize("word", WORDS)
def test_a_word_reads_the_same_in_a_posix_shell_and_in_powershell(word: str) -> None:
    text = typed("beatrix", "view", word)
    assert text == f"beatrix view {WORDS[word]}"
    assert POWERSHELL.fullmatch(WORDS[word])


@pytest.mark.skipif(sys.platform == "win32", reason="shlex reads POSIX shells")
@given(st.lists(st.text(st.characters(exclude_categories=["C"]), min_size=1), min_size=1))
def test_any_words_are_read_back(words: list[str]) -> None:
    assert shlex.split(typed(*words)) == words


def test_a_path_never_looks_like_an_option() -> None:
    assert typed("beatrix", "replay", Path("-x.rrd")) == "beatrix replay ./-x.rrd"


def test_the_advice_for_another_router_needs_no_variable_of_a_shell(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda _: "/usr/bin/beatrix")
    text = advice("tcp/[::1]:7940", ["top"], Path("logs"))
    assert '  beatrix top --connect "tcp/[::1]:7940"\n' in text
    monkeypatch.setattr("shutil.which", lambda _: None)
    assert advice("", ["top"], Path("logs")).split()[5].endswith("beatrix")


SAFE = {
    *("number", "found.number", "robot.name", "account.name", "name", "VIRTUAL", "self._port"),
    *("extra", "EXTRAS.get(process, process)", "DISTRIBUTION"),
}
"""Values that contain only letters of names and digits, or are quoted already."""
COMMAND = re.compile(r"beatrix [a-z]+(?:{[^{}\n]*|[^.;`{\n])*")


def test_every_printed_command_is_quoted_in_one_place() -> None:
    values = {
        value
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
        for command in COMMAND.findall(path.read_text(encoding="utf-8"))
        for value in re.findall(r"{([^{}]*)", command)
        if not value.startswith(("typed(", "'' if self._port"))
    }
    assert values == SAFE
