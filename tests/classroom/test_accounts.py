"""Accounts that the router refuses, the error messages for their users, and the protection of secrets."""

from __future__ import annotations

import datetime as dt
import stat
from pathlib import Path

import msgspec
import pytest
from class_router import CLI, ClassRouter, certified
from robots import Process, free_endpoint
from shell import beatrix

from beatrix_zenoh import Robot
from beatrix_zenoh import account as accounts
from beatrix_zenoh import bus as zbus
from beatrix_zenoh.account import Account
from beatrix_zenoh.classroom.certificates import Authority
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract.errors import NoAnswer, WrongUsage
from beatrix_zenoh.doctor import checks
from beatrix_zenoh.settings import resolve


def refused(endpoint: str, account: Account | None) -> str:
    """Connect with an account that the router must refuse; return the error message."""
    with pytest.raises(NoAnswer) as error:
        zbus.connect(endpoint, account=account)
    return error.value.message


def test_a_program_without_account_is_refused(router: ClassRouter) -> None:
    assert "beatrix join FILE" in refused(router.account("ana").connect, None)


def test_each_kind_of_wrong_certificate_has_its_own_error_message(router: ClassRouter) -> None:
    account, foreign = router.account("ana"), Authority.make("8b").certificate
    cases = {
        "the certificate may have been replaced by a newer one": router.former("ana"),
        "It may be the router of another class": certified(account, foreign),
    }
    for sentence, wrong in cases.items():
        assert sentence in refused(account.connect, wrong)


def test_an_expired_account_is_refused_before_anything_is_sent(router: ClassRouter) -> None:
    account = msgspec.structs.replace(router.account("ana"), expires=dt.date(2021, 3, 4))
    with pytest.raises(WrongUsage, match="expired on 2021-03-04"):
        zbus.connect(account.connect, account=account)


@pytest.mark.long("starts each program of a class")
@pytest.mark.parametrize(("name", "days"), [("teacher", -1), ("ana", 59)])
def test_doctor_and_top_announce_that_an_account_expires(
    router: ClassRouter, name: str, days: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    last = accounts.today() + dt.timedelta(days=days)
    account = msgspec.structs.replace(router.account(name), expires=last)
    (tmp_path / "own.toml").write_text(account.text())
    monkeypatch.setenv("BEATRIX_ACCOUNT", str(tmp_path / "own.toml"))
    (found,) = (one for one in checks.network(resolve()) if one.what == "account")
    assert found.state == {59: "advice", -1: "todo"}[days]
    command = "classroom init" if name == "teacher" else "join ana.toml"
    assert f"`beatrix {command}" in found.advice + found.todo
    shown = beatrix("top", "--once")
    if days == -1:
        assert (shown.returncode, f"`beatrix {command}" in shown.stderr) == (2, True)
    else:
        assert f"expires on {last}, in 59 days" in shown.stdout


@pytest.mark.parametrize(
    ("days", "when"),
    [(60, ""), (59, "expire on 2027-01-01, in 59 days."), (1, "in 1 day."), (-1, "expired on 2027-01-01.")],
)
def test_accounts_are_announced_as_soon_as_init_would_renew_them(days: int, when: str) -> None:
    expires = dt.date(2027, 1, 1)
    text = accounts.renewal("8b", expires, expires - dt.timedelta(days=days))
    assert when in text
    assert ("`beatrix classroom init class.toml`" in text) == bool(when)


def test_files_with_secrets_are_for_their_owner_only(router: ClassRouter) -> None:
    found = [path for path in router.folder.rglob("*") if path.is_file()]
    assert {"router.toml", "router-authority.pem", "cards.html", "ana.toml"} <= {path.name for path in found}
    for path in found:
        assert stat.S_IMODE(path.stat().st_mode) == 0o600, path


@pytest.fixture
def joined(router: ClassRouter, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Account:
    """Join a class as the seat ana, in a folder of its own; return the account."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    done = beatrix("join", str(router.path("ana")))
    assert done.returncode == 0, done.stderr
    assert "Joined class 8b as ana" in done.stdout
    assert "The router accepts this account." in done.stdout
    return router.account("ana")


def test_after_join_all_programs_use_router_and_name_of_the_account_and_show_no_secret(
    router: ClassRouter, joined: Account, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stored, log = tmp_path / "beatrix" / "account.toml", tmp_path / "log"
    assert stat.S_IMODE(stored.stat().st_mode) == 0o600
    with monkeypatch.context() as of_node:
        of_node.setenv("RUST_LOG", "debug")
        node = Process(*CLI, "hw", "--port", "virtual:", "--log-file", str(log), folder=tmp_path)
    try:
        assert node.expect("ready") == f"ready {keys.alive('ana', 'hw')}"  # the seat's own robot
        assert "ana" in beatrix("ls").stdout
        for verb in ("enable", "calibrate", "stop"):
            done = beatrix(verb)
            assert done.returncode == 0, done.stderr
        with Robot() as robot:
            assert (robot.name, robot.client.settings.who) == ("ana", "ana")
        listed = "".join(
            Path(f"/proc/{pid}/{file}").read_text(errors="replace")
            for pid in (node.pid, router.process.pid)
            for file in ("cmdline", "environ")
        )
    finally:
        assert node.end() == 0
    written = log.read_text() if log.exists() else ""
    everything = listed + "\n".join(node.lines) + "\n".join(router.process.lines) + written + repr(joined)
    assert joined.key.splitlines()[1] not in everything


def test_names_of_other_accounts_are_rejected_without_a_request(joined: Account) -> None:
    assert beatrix("enable", "--who", "ben").returncode == 2
    node = beatrix("hw", "--port", "virtual:", "--name", "bea1")
    assert node.returncode == 2
    assert "accepts only a robot of the same name" in node.stderr


def test_stop_needs_no_readable_account(
    joined: Account, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "beatrix" / "account.toml").write_text("password = 3\n")
    done = beatrix("ls")
    assert done.returncode == 2
    assert "is not an account file" in done.stderr
    # Robots of the developer may be at the default router; STOP must not reach them.
    monkeypatch.setenv("BEATRIX_CONNECT", free_endpoint())
    done = beatrix("stop")
    assert "is not an account file" in done.stderr
    assert done.returncode == 3, "the program looked for a router"


def test_an_account_may_be_named_by_a_file_or_the_environment(
    router: ClassRouter, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "beatrix.toml").write_text(f'account = "{router.path("bea1")}"\n')
    assert (resolve().robot, resolve().who, resolve().connect) == ("bea1", "bea1", router.classroom.listen)
    monkeypatch.setenv("BEATRIX_ACCOUNT", str(router.path("teacher")))
    assert resolve().who == "teacher"
    assert resolve(robot="bea2", who="ana").who == "ana"


FILE = """class = "8b"
name = "ana"
role = "student"
connect = "tls/h:1"
expires = "2030-01-01"
authority = ""
certificate = ""
key = ""
"""


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("ana, please", "it is not written in TOML"),
        ('[project]\nname = "x"\n', "Object contains unknown field `project`"),
        (FILE.replace("student", "boss"), "Invalid enum value 'boss' - at `$.role`"),
        (FILE.replace("tls/", "tcp/"), "its router must have endpoints that begin with tls/"),
    ],
)
def test_the_error_for_a_wrong_file_names_cause_and_right_file(tmp_path: Path, text: str, cause: str) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    done = beatrix("join", str(path))
    assert done.returncode == 2
    assert f"is not an account file: {cause}" in done.stderr
    assert "Use the file of your seat or robot, for example ana.toml" in done.stderr


def test_the_account_of_a_class_is_not_used_for_another_router(joined: Account) -> None:
    elsewhere = resolve("toy", "tcp/127.0.0.1:1", "zoe")
    assert (elsewhere.account, elsewhere.robot, elsewhere.who) == (None, "toy", "zoe")
    assert resolve(connect=joined.connect).account == joined
