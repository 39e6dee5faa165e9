"""The rules for requests to the control page: hosts, origins, PIN, cookies. They use neither network nor clock."""

from __future__ import annotations

import hmac
import os
import secrets
from collections import deque
from collections.abc import Sequence
from itertools import count
from pathlib import Path
from typing import Final, NamedTuple, Protocol

from beatrix_zenoh import files
from beatrix_zenoh.account import Account
from beatrix_zenoh.contract.errors import wrong_usage

PIN_VARIABLE: Final = "BEATRIX_WEB_PIN"
PIN_MIN, PIN_MAX = 6, 64
WINDOW_S: Final = 60.0
"""Time for which a wrong PIN counts."""
WRONG_MAX: Final = 5
"""Largest number of wrong PINs of one address within WINDOW_S: for all PINs of six digits it needs four months."""

OWN_STYLES: Final = "'self'"
BLOCK_STYLES: Final = "'self' 'sha256-Mpp7TbvFHtv0YspXin2MLIdaArPaD5O+gFUwoq8z38c=' 'sha256-xyn+siE7dlrphGa56tdAxYa7fIB6tr5xH9byXc4LASE='; style-src-attr 'unsafe-inline'"
"""The two style sheets that Blockly writes into the page, and its style attributes; scripts stay 'self'."""
FOREIGN_HOST: Final = (
    "This server does not serve this address. Open the address that `beatrix web` has printed."
)
FOREIGN_ORIGIN: Final = "Another page has sent this request. Requests are accepted from the control page only: open it and try again."
NO_COOKIE: Final = "This browser is not logged in. Load the control page again."


def chosen_pin() -> str | None:
    """Return the PIN in BEATRIX_WEB_PIN; None if it is not set. Raises WrongUsage if it is too short or too long."""
    given = os.environ.get(PIN_VARIABLE)
    pin = None if given is None else given.strip()  # as the typed PIN
    if pin is None or PIN_MIN <= len(pin) <= PIN_MAX:
        return pin
    text = f"The PIN in {PIN_VARIABLE} has {len(pin)} characters: choose {PIN_MIN} to {PIN_MAX}, or unset it to get a new PIN at each start."
    raise wrong_usage(text)


def new_pin() -> str:
    """Return a random PIN of six digits."""
    return f"{secrets.randbelow(10**PIN_MIN):0{PIN_MIN}d}"


def host_allowed(host: str, address: str, port: int, given: Sequence[str] = ()) -> bool:
    """Return whether a Host header names the address and port at which the connection has arrived.

    A foreign page whose name is rebound to this computer (DNS rebinding) sends that name, and is refused: only the IP
    address, `localhost` on the loopback interface, and the names that a class file gives, are accepted.
    """
    names = [address, *(name.lower() for name in given), *["localhost"] * (address == "127.0.0.1")]
    return host.lower() in {f"{name}:{port}" for name in names} | ({*names} if port == 80 else set())


def origin_allowed(origin: str | None, host: str) -> bool:
    """Return whether an Origin header is that of the page at an allowed host; browsers always send one with a POST."""
    return origin == f"http://{host.lower()}"


def headers(host: str, styles: str) -> dict[str, str]:
    """Return the headers of every reply: the page loads nothing from elsewhere, and no other page may show it.

    `styles`: OWN_STYLES, or BLOCK_STYLES for the page with blocks.
    """
    own_sockets = f"ws://{host}"  # named, because older Safari does not count web sockets as 'self'
    policy = (
        f"default-src 'none'; script-src 'self'; style-src {styles}; img-src 'self' blob:; media-src blob:; connect-src 'self' {own_sockets}; "
        "form-action 'self'; base-uri 'none'; frame-ancestors 'none'"
    )
    return {
        "Content-Security-Policy": policy,
        "X-Frame-Options": "DENY",
        "X-Content-Type-Options": "nosniff",
        "Referrer-Policy": "same-origin",  # with no-referrer the form would have the origin `null`, which is refused
        "Cross-Origin-Resource-Policy": "same-origin",
        "Cache-Control": "no-store",
    }


class Guesses:
    """Counts what was typed wrongly at each address."""

    def __init__(self, most: int) -> None:
        """`most`: the number within WINDOW_S after which an address has to wait."""
        self._most = most
        self._wrong: dict[str, deque[float]] = {}
        """times of the newest ones of each address (monotonic clock, s)"""

    def wait_s(self, address: str, now_s: float) -> float:
        """Return how long this address has to wait (s); 0: it need not."""
        wrong = self._wrong.get(address, deque())
        left_s = wrong[0] + WINDOW_S - now_s if len(wrong) == self._most else 0.0
        return max(1.0, left_s) if left_s > 0 else 0.0

    def add(self, address: str, now_s: float) -> None:
        """Count a wrong one."""
        self._wrong.setdefault(address, deque(maxlen=self._most)).append(now_s)


class Entry(NamedTuple):
    """What came of a PIN or word."""

    ticket: str = ""
    """content of the browser's cookie; empty: it gets none"""
    refusal: str = ""
    """key of the text that says why"""
    wait_s: float = 0.0
    """how long the address has to wait"""


class Login(Protocol):
    """Decides which browsers may use the page."""

    kind: str
    """what is typed, `pin` or `word`; empty: nothing is needed"""
    secret: str
    """what signs the cookies"""
    addresses: Sequence[str]
    """names of this computer that a browser may open"""
    folder: Path
    """where the programs of pages are kept"""

    def enter(self, typed: str, address: str, now_s: float) -> Entry:
        """Check what a browser of this address has typed, and count it if it is wrong."""

    def visitor(self, ticket: str) -> str | None:
        """Return the name of the browser with a ticket; None if the ticket is not valid, or no longer."""

    def robots(self, visitor: str, present: tuple[str, ...]) -> tuple[str, ...]:
        """Return the robots that a page offers, its own first, given the names online."""

    def account(self, visitor: str) -> Account | None:
        """Return the account of a browser; None: it drives under the seat of the server, or a name that it types.

        Raises WrongUsage (BAD_VALUE) if the account cannot be read.
        """

    def shown(self, visitor: str) -> str:
        """Return the name that a page shows for a seat of a class; empty: there is no class."""


class PinLogin:
    """Checks the PIN; the names of browsers are guest-1, guest-2 and so on."""

    addresses: Sequence[str] = ()

    def __init__(self, pin: str | None, only: str | None) -> None:
        """Set the PIN, and the only robot that pages offer.

        Without a PIN every browser that reaches the server may use the page, without `only` every robot at the router.
        """
        self._only, self.folder = only, files.user_folder()
        self.kind, self.secret = "pin" if pin is not None else "", secrets.token_urlsafe(32)
        self._pin, self._guests, self._guesses = pin, count(1), Guesses(WRONG_MAX)

    def enter(self, typed: str, address: str, now_s: float) -> Entry:
        """Check what was typed, and count a wrong PIN."""
        if wait_s := self._guesses.wait_s(address, now_s):
            return Entry(refusal="page.wait", wait_s=wait_s)
        if self._pin is None or hmac.compare_digest(typed.strip().encode(), self._pin.encode()):
            return Entry(f"guest-{next(self._guests)}")
        self._guesses.add(address, now_s)
        return Entry(refusal="page.wrong_pin")

    def visitor(self, ticket: str) -> str | None:
        """Return the name of the browser."""
        return ticket or None

    def robots(self, visitor: str, present: tuple[str, ...]) -> tuple[str, ...]:  # noqa: ARG002
        """Return all robots online, or the only one."""
        return tuple(name for name in present if self._only in (None, name))

    def account(self, visitor: str) -> None:
        """Return None: browsers have no accounts."""

    def shown(self, visitor: str) -> str:  # noqa: ARG002
        """Return nothing: there is no class."""
        return ""
