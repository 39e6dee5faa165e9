"""The control page without a network: hosts, PINs, cookies, texts and contrasts."""

from __future__ import annotations

import re
from typing import get_args

import msgspec
import pytest
from contrast import contrast

from beatrix_zenoh.contract.errors import WrongUsage
from gui.console.state import actions, intents
from gui.page import messages, protection, server
from gui.page.handlers import MALFORMED
from gui.page.protection import Login
from gui.page.server import STATIC


@pytest.mark.parametrize(
    ("host", "address", "allowed"),
    [
        ("127.0.0.1:8088", "127.0.0.1", True),
        ("localhost:8088", "127.0.0.1", True),
        ("192.168.1.20:8088", "192.168.1.20", True),
        ("localhost:8088", "192.168.1.20", False),
        ("127.0.0.1:8088", "192.168.1.20", False),
        ("127.0.0.1", "127.0.0.1", False),
        ("192.168.1.20.evil.example:8088", "192.168.1.20", False),
        ("", "127.0.0.1", False),
    ],
)
def test_only_the_address_of_the_connection_is_allowed_as_host(
    host: str, address: str, allowed: bool
) -> None:
    assert protection.host_allowed(host, address, 8088) is allowed


def test_connections_are_limited_in_total_and_for_each_address() -> None:
    assert not server.too_many(["a"] * server.ADDRESS_MAX, "b")
    assert server.too_many(["a"] * server.ADDRESS_MAX, "a")
    assert server.too_many([str(number) for number in range(server.CONNECTIONS_MAX)], "new")


def test_one_address_gets_five_tries_a_minute() -> None:
    login = Login("123456")
    for moment in range(5):
        assert login.refusal("654321", "a", float(moment)) == protection.WRONG_PIN
    assert "Wait 56 s" in login.refusal("123456", "a", 4.0)
    assert login.refusal("123456", "b", 4.0) == ""
    assert login.refusal(" 123456 ", "a", 60.0) == ""


@pytest.mark.parametrize("pin", ["", "12345", "x" * 65])
def test_a_chosen_pin_of_another_length_than_6_to_64_is_refused(
    pin: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(protection.PIN_VARIABLE, pin)
    with pytest.raises(WrongUsage, match="choose 6 to 64") as refused:
        protection.chosen_pin()
    assert not pin or pin not in refused.value.message


def test_a_page_cannot_name_files_or_start_programs() -> None:
    allowed = get_args(messages.OWN) + get_args(messages.DRIVING)
    for intent in allowed:
        assert not {"Path", "Place"} & {str(field.type) for field in msgspec.structs.fields(intent)}
    local = {action for action in vars(actions).values() if isinstance(action, type)} & {*allowed}
    assert local == {actions.ChooseRobot, actions.MakeReady, actions.AskLease, actions.SendNow, actions.Abort}
    assert intents.LimitClass not in allowed


# -- the page ------------------------------------------------------------------------------------------

SCRIPTS = "".join(path.read_text() for path in STATIC.glob("*.js"))
STYLE = (STATIC / "page.css").read_text()
COLOURS = dict(re.findall(r"--([a-z-]+): (#[0-9a-f]{6});", STYLE))


def test_page_and_server_use_the_same_code_for_a_closed_web_socket() -> None:
    assert f"const MALFORMED = {MALFORMED};" in SCRIPTS


@pytest.mark.parametrize(
    ("text", "ground"),
    [
        *[(text, ground) for text in ("text", "dim") for ground in ("ground", "panel", "field", "raised")],
        *[(text, "panel") for text in ("good", "warn", "bad")],
        ("text", "notice"),
        ("accent-text", "accent"),
        ("held-text", "held"),
        ("stop-text", "stop"),
        ("stop-text", "stop-pressed"),
        ("accent-text", "warn"),
    ],
)
def test_texts_contrast_with_their_background(text: str, ground: str) -> None:
    assert contrast(COLOURS[text], COLOURS[ground]) >= 4.5
