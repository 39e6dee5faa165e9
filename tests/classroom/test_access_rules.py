"""Access rules of a class router as a table: which account may do what."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

import pytest
from class_router import Answering, ClassRouter, ReceivedKeys, certified, replies

from beatrix_zenoh import bus as zbus
from beatrix_zenoh.bus.sessions import reached
from beatrix_zenoh.classroom.certificates import Authority
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import NoAnswer

SIM, HW = "sim", "hw"
FORGED = b"forged"


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    """A router with the robots of the class, and those of two seats."""
    with ClassRouter(tmp_path_factory.mktemp("class")) as made:
        for robot, side in (("bea1", HW), ("bea1", SIM), ("bea2", HW), ("ana", SIM), ("ben", SIM)):
            session = made.session(robot, "robot")
            for key in (
                keys.command(robot, side, "*"),
                keys.motion(robot, side, "*"),
                keys.stop_unsigned(robot, side),
                keys.stop(robot, side, "*"),
                keys.lease(robot, side, "*"),
                keys.positions(robot, side),
                keys.info(robot, side),
                keys.program(robot, "abc"),
            ):
                Answering(session, key)
            if side == SIM:
                Answering(session, keys.target(robot))
                Answering(session, keys.sound(robot))
                Answering(session, keys.follow(robot, "*"))
            session.declare_token(keys.alive(robot, side))
            made.settled(session)
        Answering(made.session("teacher", "router"), keys.pending("bea1", HW))
        yield made


def asks(router: ClassRouter, account: str, key: str) -> bool:
    """Return whether a query of the account reaches a robot that answers."""
    return bool(replies(router.session(account), key))


def puts(router: ClassRouter, account: str, key: str) -> bool:
    """Return whether a publication of the account reaches the teacher."""
    marker = keys.status(account if account != "teacher" else "bea1", SIM)
    received = ReceivedKeys(router.session("teacher"), "beatrix/**")
    router.settled(router.session("teacher"))
    with router.open(account) as sender:
        for one in (key, marker):
            sender.put(one, b"1", "text/plain", priority="data")
        found = received.until(marker)
    received.close()
    return key in found


def serves(router: ClassRouter, account: str, key: str) -> bool:
    """Return whether a queryable of the account receives the teacher's query, and the teacher receives its reply."""
    session = router.session(account)
    Answering(session, key, payload=FORGED)
    router.settled(session)
    return FORGED in [payload for _, payload in replies(router.session("teacher"), key.replace("*", "zoe"))]


def announces(router: ClassRouter, account: str, key: str) -> bool:
    """Return whether the teacher receives a liveliness token of the account."""
    session = router.session(account)
    end = session.declare_token(key)
    router.settled(session)
    seen = key in router.session("teacher").tokens(key)
    end()
    return seen


def connects(router: ClassRouter, account: str, _: str) -> bool:
    """Return whether the account opens a session."""
    kind, name = account.split()
    own = router.account(name)
    cards = {
        "new": own,
        "old": router.former(name),
        "foreign": certified(own, Authority.make("8b").certificate),
        "expired": certified(own, days=-1),
    }
    try:
        zbus.connect(own.connect, account=cards[kind]).close()
    except NoAnswer as error:
        return error.reason is not Reason.ACCOUNT_REFUSED
    return True


def receives(router: ClassRouter, account: str, key: str) -> bool:
    """Return whether the account receives a publication of bea2 on this key."""
    position, marker = keys.positions("bea2", HW), keys.status("bea2", HW)
    session, robot = router.session(account), router.session("bea2")
    received, marked = ReceivedKeys(session, key), ReceivedKeys(session, marker)
    router.settled(session)
    for one in (position, marker):
        robot.put(one, b"1", "text/plain", priority="data")
    marked.until(marker)
    marked.close()
    received.close()
    return position in received.so_far()


def reads_router(router: ClassRouter, account: str, key: str) -> bool:
    """Return whether the account reads the admin space of the router, not only that of its own session."""
    session = router.session(account)
    return any(session.session_id not in replied for replied, _ in replies(session, key))


Kind = Callable[[ClassRouter, str, str], bool]
ANY = "*"
TABLE: list[tuple[str, Kind, str, bool]] = [
    # a student may drive the robots of the class and the seat's own robot, only under the name of the seat
    ("ana", asks, keys.command("bea1", HW, "ana"), True),
    ("ana", asks, keys.motion("bea1", SIM, "ana"), True),
    ("ana", asks, keys.motion("ana", SIM, "ana"), True),
    ("ana", asks, keys.target("bea1"), True),
    ("ana", asks, keys.command("bea1", HW, "ben"), False),
    ("ana", asks, keys.command("bea1", HW, "teacher"), False),
    ("ana", asks, keys.command("bea1", HW, ANY), False),
    ("ana", asks, keys.motion("ben", SIM, "ana"), False),
    ("ana", asks, keys.target("ben"), False),
    ("ana", puts, keys.arm_target("bea1", HW, "short"), False),
    ("ana", puts, keys.arm_target("ana", SIM, "short"), True),
    # on its own robot, too, an account acts under its own seat only
    ("ana", asks, keys.lease("ana", SIM, "ana"), True),
    ("ana", asks, keys.follow("bea1", "ana"), True),
    ("ana", asks, keys.follow("ben", "ana"), False),
    ("ana", asks, keys.lease("ana", SIM, "teacher"), False),
    ("ana", asks, keys.lease("ana", SIM, ANY), False),
    ("ana", asks, keys.lease("ana", SIM, "teache$*"), False),
    ("ana", asks, "beatrix/ana/**", False),
    ("ana", asks, keys.target("ana"), True),
    ("ana", asks, keys.stop("ana", SIM, "teacher"), False),
    ("ana", puts, keys.stop("ana", SIM, "teacher"), False),
    ("bea1", asks, keys.lease("bea1", HW, "bea1"), True),
    ("bea1", asks, keys.lease("bea1", HW, "teacher"), False),
    ("bea1", asks, keys.motion("bea1", HW, "ana"), False),
    ("bea1", asks, keys.motion("bea1", HW, ANY), False),
    # every account may read all publications
    ("ana", asks, keys.positions(ANY, ANY), True),
    ("ana", receives, "beatrix/*/*/state/*", True),
    ("bea1", receives, "beatrix/*/*/state/*", True),
    ("teacher", receives, "beatrix/**", True),
    # but under no key expression that includes keys of any length (decision 0092)
    ("ana", receives, "beatrix/**", False),
    ("ana", receives, "beatrix/*/*/state/**", False),
    ("ana", receives, "**", False),
    # every account may stop each robot, and all robots together, only under its own name
    ("ana", asks, keys.stop("bea1", HW, "ana"), True),
    ("ana", asks, keys.stop(ANY, ANY, "ana"), True),
    ("ana", asks, "beatrix/**/stop/ana", True),
    ("ana", puts, keys.stop("bea2", HW, "ana"), True),
    ("bea1", asks, keys.stop("bea2", HW, "bea1"), True),
    ("ana", asks, keys.stop("bea1", HW, "teacher"), False),
    ("ana", asks, keys.stop("bea1", HW, "an$*"), False),
    ("ana", asks, keys.stop(ANY, ANY, ANY), False),
    ("ana", puts, keys.stop("bea1", HW, ANY), False),
    ("ana", puts, "beatrix/**/stop/**", False),
    ("bea1", puts, keys.stop("bea2", HW, "ana"), False),
    # STOP without a name is the teacher's
    ("ana", asks, keys.stop_unsigned("bea1", HW), False),
    ("ana", asks, "beatrix/**/stop", False),
    ("ana", puts, keys.stop_unsigned(ANY, ANY), False),
    ("teacher", asks, keys.stop_unsigned("bea1", HW), True),
    ("teacher", puts, keys.stop_unsigned(ANY, ANY), True),
    # the teacher may do everything
    ("teacher", asks, keys.command(ANY, ANY, "teacher"), True),
    ("teacher", puts, keys.arm_target("bea1", HW, "long"), True),
    # no account reads anything about the router, and every account reads what programs say of themselves
    ("teacher", reads_router, "@/**", False),
    ("ana", reads_router, "@/**", False),
    ("ana", asks, keys.program(ANY, ANY), True),
    ("ana", serves, keys.program("ana", "def"), True),
    # a seat sends notes under its own name, to all recordings; seats record, robots do not
    ("ben", serves, keys.note(ANY, "abc"), True),
    ("teacher", asks, keys.note("teacher", ANY), True),
    ("ana", asks, keys.note("ana", ANY), True),
    ("ana", asks, keys.note("ben", ANY), False),
    # only the teacher reads what the seats have reached in lessons (test_lesson_reports.py)
    ("ana", asks, keys.lesson("ana", ANY), False),
    ("ana", serves, keys.lesson("ana", ANY), False),
    ("bea1", asks, keys.lesson(ANY, ANY), False),
    # a seat shares gestures under its own name, and reads those of the teacher (test_lesson_reports.py)
    ("ana", puts, keys.gesture("ben", "abc"), False),
    ("ana", asks, keys.gesture("ben", ANY), False),
    ("ana", asks, keys.gesture(ANY, ANY), False),
    ("ana", serves, keys.gesture("teacher", ANY), False),
    ("ana", asks, keys.note(ANY, ANY), False),
    ("bea1", serves, keys.note(ANY, "def"), False),
    ("teacher", serves, keys.note(ANY, "ghi"), True),
    # only the teacher decides for robots that are not online, and only the router takes it (test_pending.py)
    ("teacher", asks, keys.pending("bea1", HW), True),
    ("ana", asks, keys.pending("bea1", HW), False),
    ("ana", puts, keys.pending("bea1", HW), False),
    ("ana", serves, keys.pending("bea1", HW), False),
    ("bea1", serves, keys.pending("bea1", HW), False),
    # robots may serve and publish under their own names only
    ("bea1", puts, keys.positions("bea1", HW), True),
    ("ana", puts, keys.positions("ana", SIM), True),
    ("bea1", serves, keys.clock("bea1", HW), True),
    ("bea1", announces, keys.alive("bea1", HW), True),
    ("bea1", asks, keys.command("bea2", HW, "bea1"), False),
    ("ana", announces, keys.seat("ana", "abc"), True),
    # accounts cannot forge positions, tokens and queryables
    ("ana", puts, keys.positions("bea1", HW), False),
    ("ana", puts, keys.microphones("bea1", HW), False),
    ("ana", puts, "beatrix/**", False),
    ("bea1", puts, keys.positions("bea2", HW), False),
    ("ana", serves, keys.command("bea2", HW, ANY), False),
    ("bea1", serves, keys.clock("bea2", HW), False),
    ("ana", serves, keys.program("ben", "fed"), False),
    ("bea1", serves, keys.program("ana", "fed"), False),
    ("ana", announces, keys.alive("ana", SIM), True),
    ("ana", announces, keys.alive("ana", "x17"), False),
    ("ana", announces, keys.claim("ana", "x17", "abc"), False),
    ("ana", announces, keys.alive("bea9", HW), False),
    ("ana", announces, keys.claim("bea1", HW, "abc"), False),
    ("ana", announces, keys.seat("teacher", "abc"), False),
    ("bea1", announces, keys.alive("bea2", SIM), False),
    # other certificates, also those of cards that were replaced, open no session
    *(
        (f"{kind} {name}", connects, "", kind == "new")
        for kind in ("new", "old", "foreign", "expired")
        for name in ("ana", "bea1", "teacher")
    ),
]


@pytest.mark.parametrize(
    ("account", "kind", "key", "allowed"),
    TABLE,
    ids=[f"{row[0]} {row[1].__name__} {row[2].replace('/', '.')}" for row in TABLE],
)
def test_the_router_allows_exactly_what_the_table_allows(
    router: ClassRouter, account: str, kind: Kind, key: str, allowed: bool
) -> None:
    assert kind(router, account, key) is allowed


def test_the_watchdog_of_a_robot_reaches_all_sessions_with_the_robots_account(router: ClassRouter) -> None:
    """Its rules let a robot query itself only under its own seat."""
    through = router.session("bea2", "control")
    for key in (keys.stop("bea2", HW, ANY), keys.motion("bea2", HW, ANY), keys.info("bea2", HW)):
        with contextlib.closing(router.open("bea2")) as checked:
            checked.serve(key, lambda incoming: incoming.finish())
            router.settled(checked)
            assert reached(checked, through), key


def test_a_reply_under_the_name_of_another_robot_does_not_arrive(router: ClassRouter) -> None:
    everyone = keys.clock(ANY, SIM)
    liar = Answering(router.session("ben"), keys.clock("ben", SIM), keys.clock("bea1", SIM), FORGED)
    router.settled(router.session("ben"))
    assert replies(router.session("teacher"), everyone) == []
    assert liar.asked == [everyone], "it received the query, and the router dropped the forged reply"


def test_only_the_stop_key_ends_with_stop_and_a_seat() -> None:
    assert [name for name, row in keys.KEYS.items() if row.key.endswith("/stop/{who}")] == ["stop"]
