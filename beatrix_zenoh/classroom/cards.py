"""A printable card for each seat and robot, with the account as a QR code."""

from __future__ import annotations

import html
import io

import msgspec
import segno

from beatrix_zenoh.account import Account
from beatrix_zenoh.classroom.class_file import Classroom

PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title><style>
body {{ font: 11pt sans-serif; margin: 0; }}
article {{ display: inline-block; width: 8.6cm; height: 12.6cm; margin: 0.2cm; padding: 0.4cm; border: 1px dashed #888;
  box-sizing: border-box; break-inside: avoid; vertical-align: top; overflow: hidden; }}
h1 {{ font-size: 18pt; margin: 0; }} p {{ margin: 0.15cm 0; }} svg {{ width: 7.4cm; height: 7.4cm; }}
</style></head><body>
{cards}</body></html>
"""
CARD = """<article><h1>{title}</h1><p>{role} {name} in class {class_name}{teacher}</p>
<p>Router {router}</p>{code}
<p>Copy {name}.toml to this computer, or save the text of the code under this name.
Then run: <code>beatrix join {name}.toml</code></p>
</article>
"""


def cards(classroom: Classroom, accounts: list[Account]) -> str:
    """Return an HTML page with all cards, which loads no other files.

    Each code contains the text of an account file, so keep the page private.
    """
    teacher = f" of {classroom.teacher}" if classroom.teacher else ""
    return PAGE.format(
        title=html.escape(f"BEATRIX, class {classroom.name}"),
        cards="".join(
            _card(account, classroom.display_names.get(account.name) or account.name, teacher)
            for account in accounts
        ),
    )


def _card(account: Account, title: str, teacher: str) -> str:
    fields = {
        "title": title,
        "name": account.name,
        "role": account.role.capitalize(),
        "class_name": account.class_name,
        "teacher": teacher,
        "router": account.connect.replace(",", ", "),
    }
    return CARD.format(
        # The names of all pupils do not fit into the code of the teacher.
        code=_code(msgspec.structs.replace(account, names={}).text()),
        **{key: html.escape(value) for key, value in fields.items()},
    )


def _code(text: str) -> str:
    """Return a QR code as SVG; with certificates it has about 130 modules a side, which phones can read on a card."""
    drawn = io.BytesIO()
    code = segno.make(text, error="l", micro=False)
    code.save(drawn, kind="svg", xmldecl=False, svgns=True, omitsize=True, border=2)
    return drawn.getvalue().decode()
