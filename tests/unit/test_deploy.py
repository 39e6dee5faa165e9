"""The files of deploy/ agree with the programs."""

from __future__ import annotations

import re
from pathlib import Path

from beatrix_zenoh.node.systemd import PERIOD_S
from hw_node.port import MEGA_USB_IDS

DEPLOY = Path(__file__).resolve().parents[2] / "deploy"


def test_the_udev_rule_names_the_boards_that_the_node_finds() -> None:
    text = (DEPLOY / "70-beatrix.rules").read_text(encoding="utf-8")
    found = re.findall(r'idVendor}=="(\w+)", ATTRS{idProduct}=="(\w+)"', text)
    assert {(int(vendor, 16), int(product, 16)) for vendor, product in found} == MEGA_USB_IDS


def test_systemd_waits_for_several_reports_of_a_robot() -> None:
    text = (DEPLOY / "beatrix-hw.service").read_text(encoding="utf-8")
    (seconds,) = re.findall(r"^WatchdogSec=(\d+)$", text, re.MULTILINE)
    assert int(seconds) >= 4 * PERIOD_S
