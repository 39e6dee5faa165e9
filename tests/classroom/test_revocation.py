"""Cards that were replaced or removed: the running router refuses the old file of a seat, a robot and the teacher.

The router restarts by itself when `init` has changed its file.
"""

from __future__ import annotations

import queue
import shutil
import socket
from pathlib import Path

import pytest
from class_router import ANSWER_S, Answering, ClassRouter, end, replies, start_node
from gui_links import Linked
from robots import until
from shell import beatrix

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.account import Account
from beatrix_zenoh.bus import credentials
from beatrix_zenoh.classroom.router_file import Part
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer
from beatrix_zenoh.output import exit_code
from gui.console.state.state import State
from gui.console.state.world import LinkPhase

STOP = keys.stop("bea2", "hw", "{}")


def has_rights(account: Account) -> bool:
    """Return whether a STOP of the account reaches the robot bea2."""
    try:
        with zbus.connect(account.connect, account=account) as session:
            return bool(replies(session, STOP.format(account.name)))
    except NoAnswer as error:
        if error.reason not in (Reason.ACCOUNT_REFUSED, Reason.NO_ROUTER):
            raise
        return False


COMMANDS = (
    ("ls",),
    ("top", "--once"),
    ("graph",),
    ("stop",),
    ("enable",),
    ("record", "x.rrd", "--seconds", "1"),
)


@pytest.mark.long("restarts a class; test_access_rules.py has the rules")
def test_the_router_refuses_cards_that_were_replaced_and_accepts_the_new_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with ClassRouter(tmp_path) as router:
        robot = router.session("bea2")
        Answering(robot, STOP.format("*"))
        router.settled(robot)
        (tmp_path / "bea1").mkdir()
        node = start_node(tmp_path / "bea1", router.path("bea1"))
        try:
            monkeypatch.chdir(tmp_path)
            monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
            for name in ("ana", "bea1"):
                file = tmp_path / f"old-{name}.toml"
                shutil.copy(router.path(name), file)
                assert has_rights(router.account(name))
                old = router.replace(name)
                router.process.expect("ready")
                until(lambda name=name: has_rights(router.account(name)), "connected again")  # type: ignore[misc]
                assert not has_rights(old)
                done = beatrix("join", str(file))
                assert done.returncode == exit_code(Reason.ACCOUNT_REFUSED)
                assert "replaced by a newer one" in done.stderr
            line = node.expect(f"The router at {router.classroom.listen} refuses account bea1 of class 8b")
            assert "replaced by a newer one, removed" in line
        finally:
            assert node.end() == 0
        beatrix("join", str(tmp_path / "old-ana.toml"))
        for words in COMMANDS:
            done = beatrix(*words)
            assert (done.returncode, "refuses account ana of class 8b" in done.stderr) == (
                exit_code(Reason.ACCOUNT_REFUSED),
                True,
            ), (words, done)
        beatrix("join", str(router.path("ana")))
        assert [beatrix(*words).returncode for words in COMMANDS[:3]] == [0, 0, 0], "no robot is no refusal"


def test_a_seat_that_is_removed_is_put_out_at_once_and_others_notice_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with ClassRouter(tmp_path) as router:
        robot = router.session("bea2")
        Answering(robot, STOP.format("*"))
        router.settled(robot)
        ana, ben, removed = router.session("ana"), router.session("ben"), router.account("ben")
        losses: queue.SimpleQueue[str] = queue.SimpleQueue()
        for name, session in (("ana", ana), ("ben", ben), ("bea2", robot)):
            session.watch_router(lambda present, name=name: None if present else losses.put(name))  # type: ignore[misc]
        router.rewrite('["ana", "ben"]', '["ana"]')
        router.process.expect("Put out: ben.")
        assert losses.get(timeout=ANSWER_S) == "ben"
        until(lambda: ben.connection_error() is not None, "each new session ends, too")
        said = credentials.refusal(removed.connect, removed)
        assert "the teacher has removed it" in said, "also if the session ends before it is open"
        with Linked(removed.connect, who="ben", account=removed) as linked:
            banner = (
                State().view(linked.until(lambda world: world.phase is LinkPhase.REFUSED, "refused")).banner
            )
            assert banner is not None
            assert "the teacher has removed it" in banner.text
        monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
        file = tmp_path / "ben.toml"
        file.write_text(removed.text())
        assert "the teacher has removed it from the class" in beatrix("join", str(file)).stderr
        for words in (("ls",), ("info", "--name", "bea2"), ("enable", "--name", "bea2", "--on", "hw")):
            done = beatrix(*words)
            assert "refuses account ben of class 8b" in done.stderr, (words, done)
        assert has_rights(router.account("ana"))
        end(router, Part.SEATS)
        router.process.expect("The router of the seats has ended (SIGKILL)")
        until(lambda: has_rights(router.account("ana")), "the seats are connected again")
        assert not has_rights(removed), "TLS refuses it now"
        names = {losses.get_nowait() for _ in range(losses.qsize())}
        assert names <= {"ana", "ben"}, "the robot stayed connected"


@pytest.mark.long("restarts a class")
def test_a_router_that_cannot_use_the_new_file_says_so_and_tries_again(tmp_path: Path) -> None:
    with ClassRouter(tmp_path) as router, socket.create_server(("127.0.0.1", 0)) as taken:
        router.rewrite(f"port = {router.classroom.router.port}", f"port = {taken.getsockname()[1]}")
        router.process.expect("The router of robots and teacher cannot start.")
        taken.close()
        router.process.expect("The router of robots and teacher runs again.")
