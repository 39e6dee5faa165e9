"""The router, to which all clients and nodes connect."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping
from dataclasses import dataclass, field

import zenoh

from beatrix_zenoh._generated.messages import Reason
from beatrix_zenoh.bus.access_control import Grant, access_control, downsampling, low_pass_filter
from beatrix_zenoh.bus.credentials import Identity, tls
from beatrix_zenoh.bus.endpoint import endpoints, is_local
from beatrix_zenoh.bus.transport import HALF_OPEN, LEASE_MS, RUNTIME, WAIT_CLOSE_US, opened
from beatrix_zenoh.errors import WrongUsage
from beatrix_zenoh.files import private_file


@dataclass(frozen=True)
class RouterAccess:
    """Accounts of a router, and the messages that each may send."""

    grants: list[Grant]
    passwords: Mapping[str, str] = field(default_factory=dict, repr=False)
    """password of each account; empty: accounts have certificates"""
    identity: Identity | None = None
    """certificate and key of this router; None: accounts have passwords, and there is no second router"""
    link: str = ""
    """endpoint at which this router accepts the second router; empty: none"""
    first: str = ""
    """endpoint of the first router if this is the second; otherwise empty"""
    account: tuple[str, str] = field(default=("", ""), repr=False)
    """user name and password with which this router connects to the first router"""
    routers: list[str] = field(default_factory=list)
    """common names of certificates of routers"""
    rates: Mapping[str, float] = field(default_factory=dict)
    """largest rate (Hz) at which a session receives publications of each of these keys"""


def open_router(listen: str, access: RouterAccess | None = None) -> zenoh.Session:
    """Open a router, to which nodes and clients connect. Close the session to end it.

    Without `access`, every program that can connect to the router may send all messages.

    Raises:
        WrongUsage: BAD_VALUE, `listen` is not an endpoint of this computer.
        NoAnswer: NO_ROUTER, the endpoint is in use.
    """
    if not is_local(listen):
        raise WrongUsage(
            Reason.BAD_VALUE,
            f"Cannot listen at {listen}: this is the address of another computer. A router can listen at 127.0.0.1 "
            "(for this computer only), at 0.0.0.0 or [::] (for all), or at one of this computer's own addresses. "
            "For a class, correct `addresses` in class.toml and run `beatrix classroom init class.toml` again.",
        )
    os.environ.setdefault(*RUNTIME)
    settings: dict[str, object] = {
        "mode": "router",
        "listen/endpoints": endpoints(listen),
        "listen/exit_on_failure": True,
        "scouting/delay": 0,
        # Zenoh 1.9 to 1.10.2 can deadlock when it answers a query to the admin space (decision 41).
        "adminspace/enabled": False,
        "transport/link/tx/queue/congestion_control/block/wait_before_close": WAIT_CLOSE_US,
        "transport/unicast/accept_pending": HALF_OPEN,
        "transport/unicast/accept_timeout": LEASE_MS,
    }
    trouble = (
        f"Cannot listen at {listen}: another program, perhaps this router, already listens there. For a second router "
        "choose another address with --listen."
    )
    if access is None:
        return opened(settings, lambda: trouble)
    settings |= _access_settings(access)
    if access.link:
        settings["listen/endpoints"] = [*endpoints(listen), access.link]
    with contextlib.ExitStack() as stack:
        if access.passwords:  # Zenoh reads the file once, while the router opens
            lines = (f"{account}:{password}\n" for account, password in access.passwords.items())
            path = stack.enter_context(private_file("".join(lines)))
            settings["transport/auth/usrpwd/dictionary_file"] = str(path)
        return opened(settings, lambda: trouble)


def _access_settings(access: RouterAccess) -> dict[str, object]:
    settings: dict[str, object] = {
        "access_control": access_control(
            access.grants, by_certificate=not access.passwords, routers=access.routers
        ),
        "downsampling": downsampling(access.rates),
        "low_pass_filter": low_pass_filter(),
    }
    if access.identity is not None:
        settings["transport/link/tls"] = tls(access.identity, listens=True)
    if access.first:
        settings |= {
            "connect/endpoints": [access.first],
            "connect/timeout_ms": 0,
            "connect/exit_on_failure": False,
            "connect/retry": {"period_init_ms": 500, "period_max_ms": 1000, "period_increase_factor": 2},
        }
        user, password = access.account
        if password:
            settings |= {"transport/auth/usrpwd/user": user, "transport/auth/usrpwd/password": password}
    return settings
