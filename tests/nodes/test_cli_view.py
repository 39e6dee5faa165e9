"""`beatrix view`: shows robots in a browser of this computer; without a screen it prints an error."""

from __future__ import annotations

import http.client
import re
import signal
import sys
import urllib.request
from pathlib import Path

import pytest
from robots import Stage

from beatrix_zenoh import Refused
from beatrix_zenoh.processes import free_port
from beatrix_zenoh.recording.viewer import answers, program


def test_live_robots_are_shown_in_a_browser() -> None:
    port, page = free_port(), free_port()
    with Stage() as stage:
        words = ("view", "--web", "--connect", stage.endpoint, "--port", str(port), "--web-port", str(page))
        process = stage.process("beatrix_zenoh.cli", *words)
        url = process.expect("ready ").removeprefix("ready ")
        assert re.fullmatch(
            rf"http://127\.0\.0\.1:{page}\?url=rerun%2Bhttp%3A%2F%2F127\.0\.0\.1%3A{port}%2Fproxy", url
        )
        with urllib.request.urlopen(url, timeout=5.0) as answer:
            assert b"<html" in answer.read().lower()
        if sys.platform == "linux":
            assert listening(port) == listening(page) == {"0100007F"}, "no other computer can connect"
        assert allowed_origin(port, f"http://127.0.0.1:{page}") == f"http://127.0.0.1:{page}"
        assert allowed_origin(port, "https://elsewhere.example") is None, "no other page reads the data"
        assert process.end(signal.SIGTERM) == 0
    assert not answers(port)
    assert not answers(page)


def listening(port: int) -> set[str]:
    """Return the addresses on which the port is open, in the notation of /proc/net/tcp."""
    rows = [
        row.split()
        for table in ("tcp", "tcp6")
        for row in Path("/proc/net", table).read_text(encoding="ascii").splitlines()[1:]
    ]
    ends = [row[1].split(":") for row in rows if row[3] == "0A"]
    return {address for address, number in ends if int(number, 16) == port}


def allowed_origin(port: int, origin: str) -> str | None:
    """Return the origin that the viewer's server allows in its reply to a browser with this origin."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=5.0)
    asked = {"Origin": origin, "Access-Control-Request-Method": "POST"}
    connection.request("OPTIONS", "/rerun.sdk_comms.v1alpha1.MessageProxyService/ReadMessages", headers=asked)
    answer = connection.getresponse().getheader("access-control-allow-origin")
    connection.close()
    return answer


def test_without_the_extra_the_error_names_the_package_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda _name: None)
    with pytest.raises(Refused, match="beatrix install rerun"):
        program()
