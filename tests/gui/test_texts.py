"""The texts: every language has every text with the same slots, and every text is used."""

from __future__ import annotations

import re
import string
from pathlib import Path

import pytest
from gui_worlds import state_after, world
from present import present

from beatrix_zenoh.blocks.program import SENTENCES
from beatrix_zenoh.client.choreography import GESTURES
from beatrix_zenoh.contract._generated.messages import FollowState, Reason
from beatrix_zenoh.contract.names import ARMS
from gui.console.link.outcomes import WindowError, failed
from gui.console.state import intents
from gui.console.state.arms import ROTATIONS
from gui.console.texts import LANGUAGES, Texts, load

GUI = Path(__file__).resolve().parents[2] / "gui"
TABLES = {code: load(code)[0] for code in LANGUAGES}
ENGLISH = TABLES["en"]
OTHERS = [code for code in LANGUAGES if code != "en"]
SOURCE = "\n".join(
    path.read_text()
    for path in GUI.rglob("*")
    if path.suffix in {".py", ".js", ".html"} and "vendor" not in path.parts
)
QUOTED = re.compile(r"""["'`]([\w.-]+)["'`]""")
TOPICS = "|".join({key.partition(".")[0] for key in ENGLISH})
KEY = re.compile(rf"""["'`]((?:{TOPICS})(?:\.(?:{{[^}}]*}}|[\w$-])+)?)["'`]""")
"""A string that begins like the key of a text; braces contain Python or JavaScript."""
NO_KEYS = (".html", ".js", "NAME")
WRITTEN = {key for key in KEY.findall(SOURCE) if not key.endswith(NO_KEYS)}
PATTERNS = {re.compile("(.+)".join(map(re.escape, re.split(r"\$?{[^}]*}", key)))) for key in WRITTEN}
"""Regular expressions of the keys that console, window and page use; a group for each part that they compose."""


def slots(template: str) -> set[str]:
    return {name for _, name, _, _ in string.Formatter().parse(template) if name}


def is_used(key: str, words: set[str]) -> bool:
    """Return whether the code contains a key, or the words of which it is composed."""
    keys = (key, key.removesuffix("_tip"))  # `views.button` adds it
    matches = (pattern.fullmatch(one) for pattern in PATTERNS for one in keys)
    return any(match and words.issuperset(match.groups()) for match in matches)


@pytest.mark.parametrize("code", OTHERS)
def test_languages_have_the_same_keys_and_slots(code: str) -> None:
    """A text that is the library's own sentence in English has further slots in other languages."""
    assert list(TABLES[code]) == list(ENGLISH)
    different = {key for key, text in TABLES[code].items() if slots(text) != slots(ENGLISH[key])}
    assert {key for key in different if ENGLISH[key] != "{text}"} == set()


@pytest.mark.parametrize("code", LANGUAGES)
def test_texts_are_not_empty_and_have_no_exclamation_marks(code: str) -> None:
    assert {key for key, text in TABLES[code].items() if not text.strip() or "!" in text} == set()


def test_every_key_that_is_used_exists() -> None:
    assert len(PATTERNS) > 400
    dotted = {pattern for pattern in PATTERNS if r"\." in pattern.pattern}
    assert {one for one in dotted if not any(one.fullmatch(key) for key in ENGLISH)} == set()


def test_every_text_is_used() -> None:
    jogs = {f"{part}-{way}" for part in ROTATIONS for way in ("plus", "minus")}
    words = {*QUOTED.findall(SOURCE), *ARMS, *GESTURES, *FollowState, *SENTENCES, *jogs}
    assert [key for key in ENGLISH if not is_used(key, words)] == []


def test_numbers_have_the_decimal_sign_of_the_language() -> None:
    assert Texts("en")("countdown", seconds=1.4) == "hardware follows in 1.4 s"
    assert Texts("de")("countdown", seconds=1.4) == "Hardware folgt in 1,4 s"
    assert Texts("de")("angle", degrees=-0.04) == "0,0°"


def test_the_failures_of_the_window_itself_are_in_its_language() -> None:
    state = state_after(intents.Choose("language", "de"), intents.Jog("short", 1))
    state.report(failed(1, "sim", WindowError(Reason.STOPPED, "result.deselected")))
    view = state.view(world())
    assert present(view.arms.refusal).text == Texts("de")("result.deselected")
    assert Texts("de")("result.deselected") in view.history[0].result


@pytest.mark.parametrize("code", LANGUAGES)
def test_no_refusal_names_a_command_to_type(code: str) -> None:
    _, refusals = load(code)
    assert {
        key for key, text in refusals.refusals.items() if re.search(r"`beatrix| --|BEATRIX_", text)
    } == set()
