"""The rules for requests to the control page: hosts, origins, PIN, cookies. They use neither network nor clock."""

from __future__ import annotations

import hmac
import os
import secrets
from collections import deque
from typing import Final

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import WrongUsage

PIN_VARIABLE: Final = "BEATRIX_WEB_PIN"
PIN_MIN, PIN_MAX = 6, 64
WINDOW_S: Final = 60.0
"""Time for which a wrong PIN counts."""
WRONG_MAX: Final = 5
"""Largest number of wrong PINs of one address within WINDOW_S: for all PINs of six digits it needs four months."""

WRONG_PIN: Final = "This PIN is wrong. Read it at the computer that runs `beatrix web`."
WAIT: Final = "There were too many wrong PINs. Wait {seconds:.0f} s, then type the PIN again."
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
    raise WrongUsage(Reason.BAD_VALUE, text)


def new_pin() -> str:
    """Return a random PIN of six digits."""
    return f"{secrets.randbelow(10**PIN_MIN):0{PIN_MIN}d}"


def host_allowed(host: str, address: str, port: int) -> bool:
    """Return whether a Host header names the address and port at which the connection has arrived.

    A foreign page whose name is rebound to this computer (DNS rebinding) sends that name, and is refused: only the IP
    address, and `localhost` on the loopback interface, are accepted.
    """
    names = [address, "localhost"] if address == "127.0.0.1" else [address]
    return host.lower() in {f"{name}:{port}" for name in names} | ({*names} if port == 80 else set())


def origin_allowed(origin: str | None, host: str) -> bool:
    """Return whether an Origin header is that of the page at an allowed host; browsers always send one with a POST."""
    return origin == f"http://{host.lower()}"


def headers(host: str, styles: str = "'self'") -> dict[str, str]:
    """Return the headers of every reply: the page loads nothing from elsewhere, and no other page may show it.

    `styles`: the sources of styles; BLOCK_STYLES for the page with blocks.
    """
    own_sockets = f"ws://{host}"  # named, because older Safari does not count web sockets as 'self'
    policy = (
        f"default-src 'none'; script-src 'self'; style-src {styles}; img-src 'self' blob:; connect-src 'self' {own_sockets}; "
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


class Login:
    """Checks PINs; returns sentences for the user."""

    def __init__(self, pin: str | None) -> None:
        """Set the PIN; None: every browser that reaches the server may use the page."""
        self._pin = pin
        self._wrong: dict[str, deque[float]] = {}
        """times of the newest wrong PINs of each address (monotonic clock, s)"""

    @property
    def needed(self) -> bool:
        """Whether a PIN is needed."""
        return self._pin is not None

    def refusal(self, typed: str, address: str, now_s: float) -> str:
        """Return the reason why this PIN is refused, and count a wrong one; empty if it is accepted."""
        if self._pin is None:
            return ""
        wrong = self._wrong.setdefault(address, deque(maxlen=WRONG_MAX))
        if len(wrong) == WRONG_MAX and (wait_s := wrong[0] + WINDOW_S - now_s) > 0:
            return WAIT.format(seconds=max(1.0, wait_s))
        if hmac.compare_digest(typed.strip().encode(), self._pin.encode()):
            return ""
        wrong.append(now_s)
        return WRONG_PIN
