"""Sphinx's settings of the site of docs/: `make site`. The pages stay plain Markdown; what only a site needs is added here."""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Iterator
from operator import attrgetter
from pathlib import Path

from docutils import nodes
from sphinx.addnodes import download_reference, pending_xref
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.ext.napoleon import Config, GoogleDocstring
from sphinx.util import logging
from sphinx.util.inspect import signature, stringify_signature
from sphinx.util.matching import patfilter

import beatrix_zenoh

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tools"))
import surface  # noqa: E402

FRONT = "docs/README"
CHAPTERS = {
    FRONT: {
        "Begin": ["docs/get-it", "docs/README.de"],
        "Try it": [
            "docs/tutorial/first-minutes",
            "docs/tutorial/first-steps",
            "docs/how-to/window",
            "docs/how-to/web",
            "docs/how-to/blocks",
            "docs/gallery",
        ],
        "Teach": [
            "docs/lessons/first-lesson",
            "docs/lessons/README",
            "docs/how-to/lessons",
            "docs/how-to/tablets",
            "docs/how-to/classroom",
            "docs/how-to/share-a-robot",
            "docs/explanation/data-protection",
        ],
        "Build": ["docs/how-to/build", "docs/how-to/board", "docs/how-to/cameras", "docs/how-to/microphones"],
        "Mend": ["docs/how-to/what-can-go-wrong", "docs/how-to/no-answer"],
        "More": ["docs/how-to/README", "docs/reference/README", "docs/explanation/README", "CONTRIBUTING"],
    },
    "docs/README.de": {"Pages": ["docs/lessons/first-lesson.de", "docs/tutorial/first-steps.de"]},
    "docs/lessons/README": {"Pages": ["docs/lessons/*"]},
    "docs/how-to/README": {"Pages": ["docs/how-to/*"]},
    "docs/reference/README": {
        "Pages": ["docs/reference/python", "docs/reference/commands", "docs/reference/*"]
    },
    "docs/explanation/README": {"Pages": ["docs/explanation/architecture", "docs/explanation/[!d]*"]},
    "CONTRIBUTING": {
        "Pages": ["README", "CHANGELOG", "SECURITY", "tests/README", "docs/explanation/decisions/README"]
    },
}
"""The chapters below a page, and their pages; a pattern adds the pages that are not listed before it."""
API = re.compile(r"^<!-- api: (.+?)(?:\n((?:.+\n)+))? ?-->$", re.MULTILINE)
"""Names to document; the lines after a class are tasks, each with the methods that stand first, under its title."""
REPOSITORY = re.compile(r"^.*<!-- repository -->\n", re.MULTILINE)
"""A line for readers who see the files, not the site."""
EXAMPLE = re.compile(r"^(\S.*)\n\n(?= {4}\S)", re.MULTILINE)
"""The paragraph before an indented program, which reStructuredText would take for a quotation."""
BASES = "Struct, tuple, str, Exception, BaseException, Status, Info, FrameHeader, SoundHeader, Sample"
"""Classes whose members are described elsewhere: those of Python, and the messages."""
GENERATED = "beatrix_zenoh.contract._generated."
ELSEWHERE = {
    "messages.Command": "messages#commands",
    "robot.GeometryData": "robot#geometry",
    "robot.LimitsData": "robot#limits",
}

SEARCHED = re.compile(r"^<!-- search: (.+) -->$", re.MULTILINE)
"""Words for which a search shows this place first, separated by commas."""

project = "BEATRIX"
version = release = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
html_title = f"BEATRIX {version}"

extensions = ["myst_parser", "sphinx.ext.autodoc"]
root_doc = FRONT
include_patterns = ["docs/**", "*.md", "tests/README.md", "beatrix_zenoh/lessons/library/*/*.md"]
exclude_patterns = ["build", ".venv", ".git"]
myst_heading_anchors = 4  # as GitHub numbers them, so that links work on both
suppress_warnings = [
    "toc.not_included",  # decisions: their own page lists them
    "misc.highlighting_failure",  # a language without colours, such as csv
]
nitpicky = True  # every type of the library in a signature has an entry of its own
nitpick_ignore_regex = [
    (r"py:.*", r"(?!beatrix_zenoh\.).*"),
    (
        r"py:.*",
        r".*\.(T|T_co|MotionT|PreviewT|Client)",
    ),  # of no use to programs
]

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_class_signature = "mixed"
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 80
add_module_names = False
default_role = "code"  # docstrings have Markdown's backticks

html_theme = "furo"
html_static_path = ["static"]
html_extra_path = ["index.html"]
html_css_files = ["site.css"]
html_search_scorer = str(Path(__file__).with_name("scorer.js"))
html_copy_source = False
html_show_copyright = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": True}


def complete(app: Sphinx, page: str, source: list[str]) -> None:
    """Add its chapters to a page, and the documentation of each class to the page that names it."""
    source[0] = API.sub(api, REPOSITORY.sub("", source[0]))
    if page in CHAPTERS:
        source[0] += "".join(chapters(app, page))


def chapters(app: Sphinx, above: str) -> Iterator[str]:
    """Yield the directive of each chapter below a page; a page is in the first chapter that has it."""
    listed = {FRONT}
    for page, parts in CHAPTERS.items():
        for title, patterns in parts.items():
            found = [one for pattern in patterns for one in patfilter(sorted(app.env.found_docs), pattern)]
            pages = [one for one in dict.fromkeys(found) if one not in listed]
            listed.update(pages)
            if page == above:
                yield f"\n\n```{{toctree}}\n:hidden:\n:caption: {title}\n\n/" + "\n/".join(pages) + "\n```\n"


def api(found: re.Match[str]) -> str:
    """Return the directives that document these names."""
    entries = [
        f".. autofunction:: {name}" if name.rpartition(".")[2].islower() else entry(name, found[2] or "")
        for name in found[1].split()
    ]
    return "```{eval-rst}\n" + "\n\n".join(entries) + "\n```"


def entry(path: str, tasks: str) -> str:
    """Return the directive of a class: its methods by task, then all other members that programs use."""
    name = path.rpartition(".")[2]
    groups = [
        (title, methods.split()) for title, _, methods in (row.partition(":") for row in tasks.splitlines())
    ]
    hidden = [one.partition(".")[2] for one in surface.OURS if one.startswith(f"{name}.")]
    listed = [method for _, methods in groups for method in methods]
    public = any(base.__name__ in beatrix_zenoh.__all__ for base in surface.classes()[name].__bases__)
    text = f".. autoclass:: {path}\n   :members:\n   :undoc-members:\n"
    text += "   :show-inheritance:\n" if public else f"   :inherited-members: {BASES}\n"
    text += f"   :exclude-members: {', '.join([*hidden, *listed])}\n"
    for title, methods in groups:
        text += f"\n   .. rubric:: {title}\n"
        text += "".join(f"\n   .. automethod:: {path}.{method}\n" for method in methods)
    return text


def docstring(app: Sphinx, what: str, name: str, thing: object, options: object, lines: list[str]) -> None:
    """Convert the sections of a docstring; warn, and so end `make site` with an error, if there is no docstring."""
    if not any(lines):
        logging.getLogger(__name__).warning(
            "%s has no docstring: say what it does, with units and errors", name
        )
    elif lines[0].startswith("Alias for field number"):  # of Python; the class describes its fields
        lines.clear()
    elif what not in ("attribute", "property"):  # napoleon takes what is before a colon in them for a type
        text = EXAMPLE.sub(r"\1\n\n::\n\n", "\n".join(lines))
        lines[:] = GoogleDocstring(text.splitlines(), Config(), app, what, name, thing).lines()


def constructor(
    app: Sphinx, what: str, name: str, thing: object, options: object, text: str, returns: str
) -> tuple[str, str] | None:
    """Return the arguments of classes that programs construct; other classes come from a call and show none.

    In a method, replace type variables by the types for which they stand, such as Motion for MotionT.
    """
    if what == "method":
        classes = surface.classes()
        types = surface.type_arguments(classes[name.split(".")[-2]])
        filled = {variable: classes[kind] for variable, kind in types.items() if kind in classes}
        for variable, kind in filled.items():
            returns = re.sub(rf"~?[\w.]*\b{variable}\b", f"~{kind.__module__}.{kind.__name__}", returns or "")
        return text, returns
    if what not in ("class", "exception"):
        return None
    if name.rpartition(".")[2] not in surface.CONSTRUCTED:
        return "", ""
    return stringify_signature(
        signature(attrgetter("__init__")(thing), bound_method=True),
        unqualified_typehints=True,
        show_return_annotation=False,
    ), ""


def message(
    app: Sphinx, env: BuildEnvironment, node: pending_xref, shown: nodes.Element
) -> nodes.Element | None:
    """Link a class that is generated from the contract to its table in the reference."""
    name = node["reftarget"].removeprefix(GENERATED)
    if name == node["reftarget"]:
        return None
    page, _, place = ELSEWHERE.get(name, name.lower().replace(".", "#")).partition("#")
    uri = app.builder.get_relative_uri(node["refdoc"], f"docs/reference/{page}")
    return nodes.reference("", "", shown, internal=True, refuri=f"{uri}#{place}")


def show_sheets(app: Sphinx, doctree: nodes.document, page: str) -> None:
    """Let a click on a page of our own, such as the card of commands, show it instead of downloading it."""
    for link in list(doctree.findall(download_reference)):
        if link["filename"].endswith(".html"):
            uri = f"{'../' * page.count('/')}_downloads/{link['filename']}"
            link.replace_self(nodes.reference("", "", *link.children, internal=True, refuri=uri))


def guide(app: Sphinx, page: str, source: list[str]) -> None:
    """Add a way back to each page of a lesson, and words by which a search finds a place: main entries of the index."""
    if page.startswith("beatrix_zenoh/"):
        source[0] = f"[All lessons](/docs/lessons/README.md)\n\n{source[0]}"
    source[0] = SEARCHED.sub(
        lambda found: "```{index} ! " + found[1].replace(", ", ", ! ") + "\n```", source[0]
    )


def show_pictures(app: Sphinx, doctree: nodes.document, page: str) -> None:
    """Let a click on a picture show it in its full size, as GitHub does."""
    for picture in list(doctree.findall(nodes.image)):
        if not isinstance(picture.parent, nodes.reference):
            uri = f"{'../' * page.count('/')}_images/{app.env.images[picture['uri']][1]}"
            picture.replace_self(nodes.reference("", "", picture.copy(), internal=True, refuri=uri))


def speak(app: Sphinx, page: str, template: str, context: dict[str, object], doctree: object) -> None:
    """Name the language of German pages, for screen readers and hyphenation."""
    if page.endswith(".de"):
        context["language"] = "de"


def setup(app: Sphinx) -> None:
    """Connect the functions above."""
    app.connect("source-read", complete)
    app.connect("source-read", guide)
    app.connect("autodoc-process-docstring", docstring)
    app.connect("autodoc-process-signature", constructor)
    app.connect("doctree-resolved", show_sheets)
    app.connect("doctree-resolved", show_pictures)
    app.connect("html-page-context", speak)
    app.connect("missing-reference", message)
