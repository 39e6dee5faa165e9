"""Create and update the files of a class: accounts, router and cards."""

from __future__ import annotations

import contextlib
import html
import io
import secrets
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import msgspec
import segno

from beatrix_zenoh import account, class_words, files
from beatrix_zenoh.account import Account, Role
from beatrix_zenoh.bus.credentials import Identity
from beatrix_zenoh.class_file import Classroom
from beatrix_zenoh.class_words import Words
from beatrix_zenoh.classroom import certificates
from beatrix_zenoh.classroom.router_file import ROUTER, RouterFile, load
from beatrix_zenoh.contract.errors import WrongUsage, bad_value, wrong_usage
from beatrix_zenoh.contract.names import TEACHER

SHEET = "words.html"
AUTHORITY = "router-authority.pem"
"""File of the authority that signs the certificates of the router. In earlier versions one in `authority.pem` also signed
accounts, which no router may accept any more."""


class Made(NamedTuple):
    """Result of `init`."""

    changed: list[str]
    """accounts that are new or whose file has changed, so that it must be handed out"""
    left: list[Path]
    """files of accounts that the class no longer has"""


def write_sheet(classroom: Classroom, folder: Path) -> None:
    """Write the sheet with the word of each seat for the control page; raises OSError."""
    files.write_private(folder / SHEET, sheet(classroom, class_words.update(folder, classroom.seats)))


def folder_of(role: str) -> str:
    """Return the name of the folder of the account files of a role."""
    return "robots" if role == "robot" else "seats"


def init(classroom: Classroom, folder: Path) -> Made:
    """Write all files of the class to `folder`; existing accounts keep their credentials.

    Raises:
        Refused: BAD_VALUE, a file cannot be written.
        WrongUsage: BAD_VALUE, an existing file cannot be read.
    """
    try:
        for name in ("", "seats", "robots"):
            (folder / name).mkdir(mode=0o700, parents=True, exist_ok=True)
        signer = _Signer(folder, classroom)
        accounts, changed = [], []
        for name, role in classroom.accounts.items():
            path = folder / folder_of(role) / f"{name}.toml"
            old = account.load(path) if path.is_file() else None
            accounts.append(signer.account(classroom, name, role, old))
            if accounts[-1] != old:
                changed.append(name)
                files.write_private(path, accounts[-1].text())
        router = signer.router(classroom, folder / "router.toml", accounts)
        files.write_private(folder / "router.toml", router.text())
        files.write_private(folder / "cards.html", cards(classroom, accounts))
        write_sheet(classroom, folder)
        files.write_private(folder / "connections.nft", connections(classroom))
    except OSError as error:
        raise bad_value(f"Cannot write the files of the class: {error}.") from error
    present = [path for role in ("seats", "robots") for path in sorted((folder / role).glob("*.toml"))]
    return Made(changed, [path for path in present if path.stem not in classroom.accounts])


class _Signer:
    """Makes the certificates of accounts, and of the router with the authority, whose file stays with the teacher."""

    def __init__(self, folder: Path, classroom: Classroom) -> None:
        path = folder / AUTHORITY
        if path.is_file():
            try:
                self.authority = certificates.Authority.read(path.read_text(encoding="utf-8"))
            except ValueError as error:
                raise wrong_usage(f"{path} cannot be read: {error}.") from error
        else:
            self.authority = certificates.Authority.make(classroom.name)
            files.write_private(path, self.authority.text)

    def account(self, classroom: Classroom, name: str, role: Role, old: Account | None) -> Account:
        """Return an account with its old certificate, or with a new one if that is not of this class or expires soon.

        The common name of a new certificate has a random suffix, so that the router can distinguish it from older ones.
        """
        trusted = self.authority.certificate
        own: Account | Identity | None = old
        if own is None or own.authority != trusted or not certificates.is_current(own.certificate):
            own = certificates.account(f"{name}.{secrets.token_hex(4)}", trusted)
        return Account(
            class_name=classroom.name,
            name=name,
            role=role,
            connect=classroom.listen_seats if role == "student" else classroom.listen,
            expires=certificates.expiry(own.certificate),
            authority=trusted,
            certificate=own.certificate,
            key=own.key,
            names=dict.fromkeys(classroom.seats, "") | classroom.display_names if role == "teacher" else {},
            robots=classroom.robots if role == "teacher" else (),
        )

    def router(self, classroom: Classroom, path: Path, accounts: list[Account]) -> RouterFile:
        """Return the routers' file, with the certificate of the old one in `path` if that is still right."""
        own: RouterFile | Identity = self.authority.issue(ROUTER, classroom.addresses)
        with contextlib.suppress(WrongUsage):  # it is missing, or of an earlier version
            old = load(path)
            if old.listen == classroom.listen and self.authority.signed(old.certificate):
                own = old
        return RouterFile(
            class_name=classroom.name,
            role="router",
            listen=classroom.listen,
            listen_seats=classroom.listen_seats,
            seats=classroom.seats,
            robots=classroom.robots,
            pictures_hz=classroom.router.pictures_hz,
            authority=self.authority.certificate,
            certificate=own.certificate,
            key=own.key,
            accounts={one.name: certificates.common_name(one.certificate) for one in accounts},
            certificates={one.name: one.certificate for one in accounts},
            expires=min(certificates.expiry(own.certificate), *(one.expires for one in accounts)),
        )


CONNECTIONS = """# Limits the new connections that each other computer opens to the routers of class {name} (Linux). Type as root:
#   nft -f FILE                        until the next start of this computer
#   nft delete table inet {table}    ends it
table inet {table}
delete table inet {table}
table inet {table} {{
  set newcomers {{ type ipv4_addr; flags dynamic; timeout 1m; }}
  chain input {{
    type filter hook input priority filter; policy accept;
    iif lo accept
    tcp dport {{ {port}, {port_seats} }} ct state new update @newcomers {{ ip saddr limit rate over 4/second burst 30 packets }} drop
  }}
}}
"""
"""Rules of the kernel. A computer with a robot or a window opens some ten connections when it starts. Zenoh accepts no
connection for 0.1 s after each that sends nonsense, so 11 of them a second would keep out all newcomers."""


def connections(classroom: Classroom) -> str:
    """Return the rules that limit the new connections of each computer, for nft(8)."""
    return CONNECTIONS.format(
        name=classroom.name,
        table=f"beatrix_{classroom.name.replace('-', '_')}",
        port=classroom.router.port,
        port_seats=classroom.router.port + 1,
    )


PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title><style>
body {{ font: 11pt sans-serif; margin: 0; }}
article {{ display: inline-block; width: 8.6cm; height: 12.6cm; margin: 0.2cm; padding: 0.4cm; border: 1px dashed #888;
  box-sizing: border-box; break-inside: avoid; vertical-align: top; overflow: hidden; }}
article.slip {{ width: 5.6cm; height: 6.6cm; text-align: center; }}
.slip h1 {{ font-size: 13pt; }} .slip svg {{ width: 3.4cm; height: 3.4cm; }} .slip code {{ font-size: 15pt; }}
section + section {{ break-before: page; }}
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
    """Return an HTML page with all cards, which loads no other files; teacher, seats and robots on sheets of their own.

    Each code contains the text of an account file, so keep the page private.
    """
    teacher = f" of {classroom.teacher}" if classroom.teacher else ""
    return PAGE.format(
        title=html.escape(f"BEATRIX, class {classroom.name}"),
        cards="".join(
            f"<section>{''.join(_card(one, classroom.display_names.get(one.name) or one.name, teacher) for one in group)}"
            "</section>\n"
            for _, group in groupby(accounts, lambda account: account.role)
        ),
    )


SLIP = """<article class="slip"><h1>{title}</h1><p>{page}</p>{code}<p>Word: <code>{word}</code></p></article>
"""


def sheet(classroom: Classroom, made: Words) -> str:
    """Return an HTML page with the address of the control page and the word of each seat; the teacher's on the last sheet."""
    seats = [[*classroom.seats], [TEACHER]]
    return PAGE.format(
        title=html.escape(f"BEATRIX, class {classroom.name}: words for the page"),
        cards="".join(
            f"<section>{''.join(_slip(classroom, seat, made.words[seat]) for seat in group)}</section>\n"
            for group in seats
        ),
    )


def _slip(classroom: Classroom, seat: str, word: str) -> str:
    title = classroom.display_names.get(seat) or seat
    # After `#`, where no server and no log sees it.
    code = _code(f"{classroom.page}#{word}")
    return SLIP.format(title=html.escape(title), page=html.escape(classroom.page), code=code, word=word)


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
        # The names of all pupils and robots do not fit into the code of the teacher.
        code=_code(msgspec.structs.replace(account, names={}, robots=()).text()),
        **{key: html.escape(value) for key, value in fields.items()},
    )


def _code(text: str) -> str:
    """Return a QR code as SVG; with certificates it has about 130 modules a side, which phones can read on a card."""
    drawn = io.BytesIO()
    # The standard's choice of the best of eight masks takes three quarters of the time of a class's cards, and an
    # account is mostly base64: as even as random bits under any mask.
    code = segno.make(text, error="l", micro=False, mask=0)
    code.save(drawn, kind="svg", xmldecl=False, svgns=True, omitsize=True, border=2)
    return drawn.getvalue().decode()


def terminal_code(text: str) -> str:
    """Return a QR code for a terminal."""
    drawn = io.StringIO()
    segno.make(text, micro=False).terminal(drawn, compact=True)
    return drawn.getvalue()
