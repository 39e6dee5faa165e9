"""Which serial port is the board's."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from serial.tools import list_ports

from beatrix_zenoh import NoAnswer
from hw_node.port import find

MEGA = SimpleNamespace(device="/dev/ttyACM0", vid=0x2341, pid=0x0042)
CLONE = SimpleNamespace(device="/dev/ttyUSB0", vid=0x1A86, pid=0x7523)
MODEM = SimpleNamespace(device="/dev/ttyS0", vid=None, pid=None)


def plugged(monkeypatch: pytest.MonkeyPatch, *ports: SimpleNamespace) -> None:
    monkeypatch.setattr(list_ports, "comports", lambda: list(ports))


def test_the_only_board_is_found_among_other_ports(monkeypatch: pytest.MonkeyPatch) -> None:
    plugged(monkeypatch, MODEM, CLONE)
    assert find() == "/dev/ttyUSB0"


def test_of_several_boards_one_must_be_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    plugged(monkeypatch, MEGA, CLONE)
    with pytest.raises(NoAnswer, match=r"--port: /dev/ttyACM0, /dev/ttyUSB0"):
        find()


def test_no_board_says_which_ports_there_are_and_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    plugged(monkeypatch, MODEM)
    with pytest.raises(NoAnswer, match=r"/dev/ttyS0.*virtual:"):
        find()
