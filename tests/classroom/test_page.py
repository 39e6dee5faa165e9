"""The documentation page about a class: its class file and its commands work as printed."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from class_router import CLI, free_ports
from robots import ROOT, Process
from shell import beatrix

from beatrix_zenoh import class_file
from beatrix_zenoh.settings import resolve


def test_the_commands_of_the_page_make_a_class(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = (ROOT / "docs/how-to/classroom.md").read_text(encoding="utf-8")
    file, table = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    (tmp_path / "table.toml").write_text(re.sub(r"seats = .*\n", "", file) + table, encoding="utf-8")
    assert class_file.read(tmp_path / "table.toml").display_names["zoe"] == "Zoë Müller"
    port = str(free_ports())
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    Path("class.toml").write_text(file.replace("192.168.1.20", "127.0.0.1").replace("7447", port))
    lines = "".join(re.findall(r"```sh\n(.*?)```", page, re.DOTALL)).splitlines()
    typed = [
        line[line.index("beatrix ") :].split() for line in lines if "beatrix " in line
    ]  # some have `BEATRIX_ACCOUNT=FILE` before; others make a folder
    commands = {words[1]: words[1:] for words in typed}
    init, router, join = (commands.pop(name) for name in ("classroom", "router", "join"))
    assert all(beatrix(name, "--help").returncode == 0 for name in commands), "the commands of a lesson exist"
    done = beatrix(*init)
    assert done.returncode == 0, done.stderr
    assert Path("8b/cards.html").is_file()
    process = Process(*CLI, *router, folder=tmp_path)
    try:
        process.expect("ready")
        shutil.copy("8b/seats/ana.toml", ".")
        assert "accepts this account" in beatrix(*join).stdout
        assert (resolve().robot, resolve().who) == ("ana", "ana")
        assert str(int(port) + 1) in resolve().connect
    finally:
        assert process.end() == 0
