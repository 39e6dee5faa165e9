"""Keys, threads, tables and glossary of the pages have the names of the code; the changelog is brief."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import beatrix_zenoh
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.recording.verbs import comparison_text

ROOT = Path(__file__).resolve().parents[2]
PAGES = ROOT / "docs/explanation"
SOURCES = [
    path for folder in ("beatrix_zenoh", "sim_node", "hw_node") for path in (ROOT / folder).rglob("*.py")
]
KEY = re.compile(r"\bbeatrix/bea1/[\w@/<>-]+")
THREAD = re.compile(
    r'(?:(?:threads\.start\(.*|Schedule\(|ThreadPoolExecutor\(1, )f?"(?:beatrix-)?|"beatrix-)([\w-]+)'
)
NOT_OURS = {"Zenoh's threads"}


def test_tables_of_the_compare_page_have_the_printed_columns() -> None:
    text = (ROOT / "docs/how-to/compare.md").read_text(encoding="utf-8")
    assert comparison_text.AFTER in " ".join(text.split())
    for heads in (comparison_text.AXIS_HEADS, comparison_text.SAMPLE_HEADS):
        assert re.search(" +".join(re.escape(head) for head in heads), text)


@pytest.mark.parametrize("page", ["architecture.md", "ros-names.md"])
def test_keys_of_a_page_are_keys_of_the_contract(page: str) -> None:
    named = KEY.findall((PAGES / page).read_text(encoding="utf-8"))
    assert len(named) > 5
    assert [key for key in named if keys.parse(key.replace("<seat>", "ana")) is None] == []


def test_words_of_the_glossary_are_words_of_the_code() -> None:
    text = (PAGES / "glossary.md").read_text(encoding="utf-8")
    rows = [row for row in re.findall(r"^\| ([^|]+) \|", text, re.MULTILINE) if row != "word"]
    code = [path.read_text(encoding="utf-8") for path in (*SOURCES, *(ROOT / "schemas").glob("*.toml"))]
    everything = " ".join(" ".join(code).lower().replace("_", " ").split())
    words = [word for row in rows for word in row.split(", ")]
    assert len(words) > 50
    assert [word for word in words if word.lower().replace("_", " ") not in everything] == []


def test_threads_of_a_node_have_the_names_of_the_table() -> None:
    text = (PAGES / "architecture.md").read_text(encoding="utf-8")
    table = text.split("## Threads of a node")[1].split("##")[0]
    rows = re.findall(r"^\| ([^|]+) \|", table, re.MULTILINE)[1:]
    named = {name for row in rows for name in row.split(", ")} - NOT_OURS
    started = {name for path in SOURCES for name in THREAD.findall(path.read_text(encoding="utf-8"))}
    missing = {name for name in named if not any(name.startswith(start) for start in started)}
    assert len(named) > 10
    assert missing == set()


def test_the_python_reference_has_every_public_name() -> None:
    text = (ROOT / "docs/reference/python.md").read_text(encoding="utf-8")
    listed = {
        name for row in re.findall(r"^<!-- api: (.+?)(?: -->)?$", text, re.MULTILINE) for name in row.split()
    }
    assert {f"beatrix_zenoh.{name}" for name in beatrix_zenoh.__all__} - listed == set()


def test_each_reason_has_a_cure() -> None:
    pages = [ROOT / "docs/how-to" / name for name in ("what-can-go-wrong.md", "no-answer.md")]
    text = " ".join(page.read_text(encoding="utf-8") for page in pages)
    assert [reason for reason in Reason if f"`{reason}`" not in text] == [Reason.OK]


def test_sentences_of_the_pages_are_those_of_the_catalogue() -> None:
    files = [
        ROOT / folder / language
        for folder in ("beatrix_zenoh/contract/sentences", "gui/console/texts")
        for language in ("en.toml", "de.toml")
    ]
    catalogue = " ".join(file.read_text(encoding="utf-8") for file in files)
    pages = [ROOT / "docs/how-to" / name for name in ("what-can-go-wrong.md", "no-answer.md")]
    text = " ".join(page.read_text(encoding="utf-8") for page in pages)
    sentences = re.findall(r"<br>\*(.+?)\*(?=<br>| \|)", text)
    parts = [part.strip() for sentence in sentences for part in sentence.split("…")]
    assert len(parts) > 60
    assert [part for part in parts if part not in catalogue] == []


def test_changes_of_the_newest_version_are_one_line_each() -> None:
    newest = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").split("\n## ")[1]
    lines = newest.splitlines()[1:]
    assert [line for line in lines if len(line) > 200 or not re.match(r"- |### |$", line)] == []


def test_prose_has_lines_of_at_most_120_characters() -> None:
    pages = [
        path for path in ROOT.rglob("*.md") if not {".venv", "reference"} & set(path.relative_to(ROOT).parts)
    ]
    long = []
    for path in pages:
        text = re.sub(
            r"^( *)```.*?^\1```$", "", path.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL
        )
        prose = (line for line in text.splitlines() if not line.lstrip().startswith(("|", "![", "    ")))
        long += [f"{path.name}: {line}" for line in prose if len(line) > 120 and path.name != "CHANGELOG.md"]
    assert len(pages) > 80
    assert long == []
