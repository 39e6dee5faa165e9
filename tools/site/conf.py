"""Sphinx's settings of the site of docs/: `make site`. The pages stay plain Markdown; what only a site needs is added here."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util import logging
from sphinx.util.inspect import signature, stringify_signature

ROOT = Path(__file__).resolve().parents[2]
FRONT = "docs/README"
CHAPTERS = {
    "Try it": ["tutorial/*", "gallery", "how-to/window", "how-to/web", "how-to/blocks"],
    "Teach": ["lessons/README", "lessons/*", "how-to/lessons", "how-to/classroom", "how-to/tablets", "how-to/share-a-robot"],
    "Build": ["how-to/build-the-robot", "how-to/board", "how-to/cameras", "how-to/microphones"],
    "Mend": ["how-to/what-can-go-wrong", "how-to/no-answer"],
    "How to": ["how-to/README", "how-to/*"],
    "Look up": ["reference/python", "reference/README", "reference/*"],
    "Understand": ["explanation/*", "explanation/decisions/README"],
    "Project": ["/README", "/CONTRIBUTING", "/CHANGELOG", "/SECURITY", "/tests/README"],
    "Deutsch": ["README.de"],
}
"""The chapters of the site and their pages in docs/; a pattern adds those that no line above it has."""
CONSTRUCTED = [f"beatrix_zenoh.{name}" for name in ("Robot", "Twin", "Monitor")]
API = re.compile(r"<!-- api: (.+?) -->")
MEMBERS = "   :members:\n   :undoc-members:\n   :inherited-members: Struct, tuple, str\n   :exclude-members: args, add_note, with_traceback\n"
MESSAGES = "beatrix_zenoh.contract._generated.messages."

project = "BEATRIX"
author = "The BEATRIX on Zenoh project"
version = release = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
html_title = f"BEATRIX {version}"

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = FRONT
include_patterns = ["docs/**", "*.md", "tests/README.md"]
exclude_patterns = ["build", ".venv", ".git", "docs/explanation/decisions/0000-template.md"]
myst_heading_anchors = 4  # as GitHub numbers them, so that links work on both
nitpicky = True  # every type of the library in a signature has an entry of its own
nitpick_ignore_regex = [(r"py:.*", r"(?!beatrix_zenoh\.).*")]

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_class_signature = "mixed"
python_use_unqualified_type_names = True
add_module_names = False
default_role = "code"  # docstrings have Markdown's backticks
napoleon_numpy_docstring = False

html_theme = "furo"
html_static_path = ["static"]
html_extra_path = ["index.html"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": True}


def complete(app: Sphinx, page: str, source: list[str]) -> None:
    """Add the chapters to the front page, and the documentation of each class to the page that names it."""
    source[0] = API.sub(api, source[0])
    if page == FRONT:
        for title, pages in CHAPTERS.items():
            source[0] += f"\n```{{toctree}}\n:hidden:\n:glob:\n:caption: {title}\n\n" + "\n".join(pages) + "\n```\n"
    if page == "docs/explanation/decisions/README":
        source[0] += "\n```{toctree}\n:hidden:\n:glob:\n\n0*\n```\n"


def api(found: re.Match[str]) -> str:
    """Return the directives that document these names."""
    entries = [
        f".. autofunction:: {name}" if name.rpartition(".")[2].islower() else f".. autoclass:: {name}\n{MEMBERS}"
        for name in found[1].split()
    ]
    return "```{eval-rst}\n" + "\n\n".join(entries) + "\n```"


def check_documented(app: Sphinx, what: str, name: str, thing: object, options: object, lines: list[str]) -> None:
    """Warn, and so end `make site` with an error, if a public name has no docstring."""
    if not any(lines):
        logging.getLogger(__name__).warning("%s has no docstring: say what it does, with units and errors", name)


def constructor(app: Sphinx, what: str, name: str, thing: object, options: object, text: str, returns: str) -> tuple[str, str] | None:
    """Return the arguments of classes that programs construct; other classes come from a call and show none."""
    if what not in ("class", "exception"):
        return None
    if name not in CONSTRUCTED:
        return "", ""
    return stringify_signature(signature(thing.__init__, bound_method=True), unqualified_typehints=True), ""


def message(app: Sphinx, env: BuildEnvironment, node: pending_xref, shown: nodes.Element) -> nodes.Element | None:
    """Link a message or a word of the contract to its table on the page of messages."""
    target = node["reftarget"]
    if not target.startswith(MESSAGES):
        return None
    page = app.builder.get_relative_uri(node["refdoc"], "docs/reference/messages")
    return nodes.reference("", "", shown, internal=True, refuri=f"{page}#{target.removeprefix(MESSAGES).lower()}")


def setup(app: Sphinx) -> None:
    """Connect the functions above."""
    app.connect("source-read", complete)
    app.connect("autodoc-process-docstring", check_documented)
    app.connect("autodoc-process-signature", constructor)
    app.connect("missing-reference", message)
