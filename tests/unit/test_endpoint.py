"""Invalid endpoints and Zenoh settings raise WrongUsage with a sentence."""

from __future__ import annotations

import pytest

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.client import Client
from beatrix_zenoh.contract.errors import WrongUsage
from beatrix_zenoh.settings import Settings

WRONG = (
    "tcp/lab..local:7447",
    "tcp/lab\0local:7447",
    "tcp/127.0.0.1:\u00b2",
    "tcp/127.0.0.1:99999",
    "udp/127.0.0.1:7447",
    "7447",
)


@pytest.mark.parametrize("endpoint", WRONG)
def test_an_invalid_endpoint_raises_wrong_usage(endpoint: str) -> None:
    for use in (zbus.open_router, lambda text: Client(Settings("bea", text, "ana"))):
        with pytest.raises(WrongUsage, match=r"is not an endpoint\. Write protocol/host:port"):
            use(endpoint)


@pytest.mark.parametrize(
    ("endpoint", "host"),
    [
        ("tcp/127.0.0.1:7447", "127.0.0.1"),
        ("tcp/[::1]:7447", "::1"),
        ("tcp/lab.local:7447", "lab.local"),
        ("tcp/bücher.local:7447", "bücher.local"),
    ],
)
def test_a_valid_endpoint_is_parsed(endpoint: str, host: str) -> None:
    assert zbus.parse_endpoint(endpoint) == ("tcp", host, 7447)


def test_is_local_is_true_only_for_addresses_of_this_computer() -> None:
    hosts = ("127.0.0.1", "localhost", "192.0.2.7")
    assert [zbus.is_local(f"tcp/{host}:7447") for host in hosts] == [True, True, False]
