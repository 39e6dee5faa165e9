"""Credentials of sessions, and the causes of a refusal by the router."""

from __future__ import annotations

import base64
import socket
import ssl
from collections.abc import Mapping
from dataclasses import dataclass

from beatrix_zenoh.account import Account
from beatrix_zenoh.bus.endpoint import endpoints, parse_endpoint
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.files import private_file

PROBE_S = 2.0
BUFFERS = {"so_sndbuf": 256 * 1024, "so_rcvbuf": 32 * 1024}
"""Socket buffers (bytes). A small one for received data, as for TCP; a larger one for data to send, because Zenoh 1.10
closes a TLS connection only after all data is written, so a buffer that is full would hide a lost computer."""
PUT_OUT = "the teacher has removed it from the class, or it is put out for a minute"
"""Cause if the router accepts the certificate and closes the session, perhaps before it is open."""
REPLACED = (
    "the certificate may have been replaced by a newer one, removed, or expired, or is of another class"
)


@dataclass(frozen=True, repr=False)
class Identity:
    """Certificate and private key (PEM), and the certificate of the authority of the class."""

    authority: str
    certificate: str
    key: str


def tls(identity: Identity | Account, *, listens: bool) -> dict[str, object]:
    """Return Zenoh's section `transport/link/tls`, in which both sides must present a certificate.

    Zenoh receives the keys in memory, not in files.
    """
    certificate, key = _encoded(identity.certificate), _encoded(identity.key)
    section: dict[str, object] = {
        **BUFFERS,
        "root_ca_certificate_base64": _encoded(identity.authority),
        "enable_mtls": True,
        "connect_certificate_base64": certificate,
        "connect_private_key_base64": key,
    }
    if listens:
        section |= {"listen_certificate_base64": certificate, "listen_private_key_base64": key}
    return section


def _encoded(text: str) -> str:
    return base64.b64encode(text.encode()).decode()


def settings(account: Account | None) -> Mapping[str, object]:
    """Return Zenoh's settings with the credentials of an account; empty without an account."""
    return {} if account is None else {"transport/link/tls": tls(account, listens=False)}


def no_router(error: NoAnswer, account: Account | None) -> NoAnswer:
    """Return the error of a client that finds no router; with an account, it says how the teacher starts the router."""
    if account is None:
        return error
    return NoAnswer(
        error.reason,
        f"No router of class {account.class_name} at {account.connect}. If it has ended, it is back within some seconds, or "
        "after a minute if the seats are out: try again. Otherwise the teacher starts it with `beatrix router --class "
        "class.toml`. If it runs, check that this computer is in the same network and that no firewall blocks the "
        "port.",
    )


def refusal(endpoint: str, account: Account | None) -> str:
    """Return the message about a router that refuses this client: the possible causes, and what to do."""
    if account is None:
        return (
            f"The program at {endpoint} closes the connection: it is no router, or one of a class, which accepts only "
            "accounts. Check the address; in a class, run `beatrix join FILE` with the file of your seat."
        )
    causes = [_certificate_error(one, account) for one in endpoints(endpoint)]
    return refused(endpoint, account, next(filter(None, causes), PUT_OUT))


def refused(endpoint: str, account: Account, cause: str = PUT_OUT) -> str:
    """Return the message about a router that refuses an account, by default by closing each of its sessions."""
    return (
        f"The router at {endpoint} refuses account {account.name} of class {account.class_name}: {cause}. Ask for a new "
        f"{account.name}.toml, then run `beatrix join {account.name}.toml`."
    )


def client_context(own: Account) -> ssl.SSLContext:
    """Return a context for connections to the router with an identity; raises ssl.SSLError if it is invalid."""
    context = ssl.create_default_context(cadata=own.authority)
    with private_file(own.certificate + own.key) as path:
        context.load_cert_chain(path)
    return context


def _certificate_error(endpoint: str, own: Account) -> str:
    """Return the cause of a failed TLS handshake; empty if it succeeds or the cause is unknown."""
    _, host, port = parse_endpoint(endpoint)
    try:
        context = client_context(own)
        with (
            socket.create_connection((host, port), PROBE_S) as connection,
            context.wrap_socket(connection, server_hostname=host) as wrapped,
        ):
            wrapped.recv(1)  # in TLS 1.3 the router refuses a certificate only after the handshake
    except ssl.SSLCertVerificationError as error:
        return (
            f"its own certificate does not suit ({error.verify_message}). It may be the router of another class; if it is "
            "the right one, the teacher corrects `addresses` in class.toml and runs `beatrix classroom init`"
        )
    except ssl.SSLError as error:
        return f"TLS reports {error.reason}; {REPLACED}"
    except OSError:
        return ""
    return ""
