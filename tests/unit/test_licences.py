"""The page of licences names every package, and packages under the GPL are in extras that say so."""

from __future__ import annotations

import re

import licences
import pytest
from robots import ROOT

pytestmark = pytest.mark.no_cover  # it runs only code of tools/

ROWS = re.findall(r"^\| (\S+) \| (.*) \| (.*) \|$", licences.PAGE.read_text(encoding="utf-8"), re.MULTILINE)


def test_the_page_names_each_package_that_an_extra_needs() -> None:
    missing = set(licences.extras_of()) - {name for name, _, _ in ROWS}
    assert not missing, "type `beatrix install all`, then `python tools/licences.py`"


def test_packages_under_the_gpl_are_in_extras_that_say_so() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    found = {
        extra
        for name, licence, extras in ROWS
        if licences.Package(name, "", licence, ()).gpl
        for extra in extras.split(", ")
    }
    assert found >= {"gui", "video"}
    assert [one for one in found if "GPL" not in text.partition(f"\n{one} = [")[2].partition("\n]")[0]] == []
