"""The texts: every language has every text with the same slots, and every text is used."""

from __future__ import annotations

import ast
import re
import string
from collections.abc import Iterator
from pathlib import Path

import pytest
from gui_worlds import state_after, world
from present import present

from beatrix_zenoh.client.choreography import GESTURES
from beatrix_zenoh.contract._generated.messages import FollowState, Reason
from beatrix_zenoh.contract.names import ARMS
from gui.console.link.outcomes import WindowError, failed
from gui.console.state import intents
from gui.console.state.arms import ROTATIONS
from gui.console.texts import LANGUAGES, Texts, load

GUI = Path(__file__).resolve().parents[2] / "gui"
CALLERS = ("texts", "_texts", "words")
TABLES = {code: load(code)[0] for code in LANGUAGES}
ENGLISH = TABLES["en"]
OTHERS = [code for code in LANGUAGES if code != "en"]
SECOND = ("refuse", "WindowError", "button")
"""Functions whose second argument is the key of a text."""


def slots(template: str) -> set[str]:
    return {name for _, name, _, _ in string.Formatter().parse(template) if name}


def literals(node: ast.AST) -> Iterator[str]:
    """Yield regular expressions for the texts that an expression may evaluate to."""
    match node:
        case ast.Constant(value=str(text)):
            yield re.escape(text)
        case ast.IfExp(body=body, orelse=orelse):
            yield from literals(body)
            yield from literals(orelse)
        case ast.JoinedStr(values=parts):
            yield "".join(
                re.escape(str(part.value)) if isinstance(part, ast.Constant) else "(.+)" for part in parts
            )


def keys_asked_for(tree: ast.AST) -> Iterator[str]:
    """Yield regular expressions for the keys of texts that calls use."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call):
            called = node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
            place = 0 if called in CALLERS else 1 if called in SECOND else len(node.args)
            for argument in node.args[place : place + 1]:
                yield from literals(argument)


def is_used(key: str, words: set[str], patterns: set[str]) -> bool:
    """Return whether the window's code contains a key, or the words of which the key is composed."""
    keys = {key, key.removesuffix("_tip")}  # `views.button` adds it
    found = (re.fullmatch(pattern, one) for pattern in patterns for one in keys)
    return bool(keys & words) or any(match and words.issuperset(match.groups()) for match in found)


def modules() -> dict[Path, ast.Module]:
    """Return all modules of console, window and page."""
    return {path: ast.parse(path.read_text(encoding="utf-8")) for path in GUI.rglob("*.py")}


@pytest.mark.parametrize("code", OTHERS)
def test_languages_have_the_same_keys_and_slots(code: str) -> None:
    """A text that is the library's own sentence in English has further slots in other languages."""
    assert list(TABLES[code]) == list(ENGLISH)
    different = {key for key, text in TABLES[code].items() if slots(text) != slots(ENGLISH[key])}
    assert {key for key in different if ENGLISH[key] != "{text}"} == set()


@pytest.mark.parametrize("code", LANGUAGES)
def test_texts_are_not_empty_and_have_no_exclamation_marks(code: str) -> None:
    assert {key for key, text in TABLES[code].items() if not text.strip() or "!" in text} == set()


def test_every_key_that_the_window_uses_exists() -> None:
    for path, tree in modules().items():
        for pattern in keys_asked_for(tree):
            found = any(re.fullmatch(pattern, key) for key in ENGLISH)
            assert found, f"{path.relative_to(GUI)}: there is no text {pattern!r}"


def words_of_the_page() -> set[str]:
    """Return the strings in the scripts of the page and the keys in its HTML."""
    files = [path.read_text() for path in (GUI / "page/static").iterdir()]
    return {word for text in files for word in re.findall(r"[\"`]([\w.-]+)[\"`]", text)}


def test_every_key_that_the_page_uses_exists() -> None:
    keys = {word for word in words_of_the_page() if re.match(r"(page|label)\.[a-z]", word)}
    assert len(keys) > 20
    assert keys - {*ENGLISH} == set()


def test_every_text_is_used() -> None:
    nodes = [node for tree in modules().values() for node in ast.walk(tree)]
    words = {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    words |= {
        *ARMS,
        *GESTURES,
        *FollowState,
        *words_of_the_page(),
        *(f"{part}-{way}" for part in ROTATIONS for way in ("plus", "minus")),
    }
    patterns = {r"page\.(.+)"} | {
        text for node in nodes if isinstance(node, ast.JoinedStr) for text in literals(node)
    }
    dotted = {pattern for pattern in patterns if re.match(r"[a-z]+\\\.", pattern)}
    assert [key for key in ENGLISH if not is_used(key, words, dotted)] == []


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
