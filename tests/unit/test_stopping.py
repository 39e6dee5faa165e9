"""STOP as clients send it: what is sent, the answers, and the threads of `StopSender`."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from types import SimpleNamespace
from typing import cast

import pytest
from golden import same
from patient_connections import PATIENCE_S
from robots import until

from beatrix_zenoh.bus import Query, Reply
from beatrix_zenoh.client import Place, stopping
from beatrix_zenoh.client.request import Request
from beatrix_zenoh.client.robot_base import RobotBase
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.stopping import (
    PLACES_MAX,
    REPORTS_MAX,
    Answer,
    Answers,
    SentGroupStop,
    SentStop,
    StopSender,
    sentence,
    stop_robots,
)
from beatrix_zenoh.contract import codec
from beatrix_zenoh.contract._generated.messages import CommandReply, Reason, Source, Vector3
from beatrix_zenoh.contract.errors import NoAnswer, Refused, WrongUsage

HW, SIM = ("bea", "hw"), ("bea", "sim")
HOME = Vector3(0.0, 0.0, 0.0)
RESTS = CommandReply(result=True, reason=Reason.OK, message="Stopped; the arms rest.", position=HOME)
MUTED = CommandReply(result=False, reason=Reason.MUTED, message="This seat is muted.", position=HOME)


class Asked:
    """A query that has these replies, then ends."""

    replies = Query.replies

    def __init__(self, replies: Sequence[Reply]) -> None:
        self.waiting: list[Reply | None] = [*replies, None]
        self.closed = False

    def next(self, _: float) -> Reply | None:
        return self.waiting.pop(0)

    def close(self) -> None:
        self.closed = True


class Network:
    """A session without a network: `sent` has the keys of publications and queries, `presses` their attachments."""

    def __init__(self, replies: dict[Place, CommandReply] | None = None, *, connected: bool = True) -> None:
        self.replies, self.connected, self.closed = replies or {}, connected, False
        self.sent: list[tuple[str, str]] = []
        self.presses: list[object] = []

    def put(self, key: str, *_: object, attachment: bytes | None = None) -> None:
        self.presses.append(attachment)
        if self.closed:
            raise WrongUsage(Reason.SHUTDOWN, "closed by this program")
        self.sent.append(("put", key))

    def query(self, key: str, *words: object, **__: object) -> Asked:
        self.presses += words[4:5]
        self.sent.append(("get", key))
        end = key.rpartition("/")[0] + "/ana" if key.endswith("/ana") else key
        tail = end.split("/", 3)[3]
        return Asked(
            [
                Reply(f"beatrix/{robot}/{side}/{tail}", codec.encode(reply))
                for (robot, side), reply in self.replies.items()
            ]
        )

    def client(self) -> Client:
        """Return a client of this session."""
        made = SimpleNamespace(
            bus=self,
            settings=SimpleNamespace(who="ana"),
            source=Source.CLI,
            losses=0,
            seen=set(),
            read=lambda answer, kind: codec.decode(answer.payload, kind),
            report=lambda *_: None,
        )
        return cast("Client", made)


@pytest.fixture
def positions(monkeypatch: pytest.MonkeyPatch) -> set[Place]:
    """The robots that publish positions."""
    found: set[Place] = set()

    def publishes(bus: object, places: Collection[Place]) -> set[Place]:
        return found & {*places}

    monkeypatch.setattr(stopping, "publishing", publishes)
    return found


# -- what is sent, and the answers --------------------------------------------------------------------


def test_stop_is_published_before_it_is_queried() -> None:
    network = Network({HW: RESTS})
    assert SentStop(network.client(), HW).answer() == RESTS
    assert network.sent == [("put", "beatrix/bea/hw/stop/ana"), ("get", "beatrix/bea/hw/stop/ana")]
    assert network.presses[:1] == network.presses[1:] != [None], "both have the number of the press"


def test_stop_of_a_group_is_published_before_it_is_queried_and_answered_by_each_robot() -> None:
    network = Network({HW: RESTS, SIM: MUTED})
    answers = SentGroupStop(network.client(), ("bea", "*")).replies()
    assert network.sent == [("put", "beatrix/bea/*/stop/ana"), ("get", "beatrix/bea/*/stop/ana")]
    assert (answers[HW], answers[SIM].reason) == (RESTS, Reason.MUTED)
    assert isinstance(answers[SIM], Refused)


def test_one_press_of_emergency_stop_has_one_number_also_as_stop_of_simulations() -> None:
    network, sender = Network({HW: RESTS, SIM: RESTS}), StopSender("emergency")
    sender.send([network.client()], [HW, SIM], lambda _: None, emergency=True)
    sender.close()
    sender.join(time.monotonic() + PATIENCE_S)
    sent = ["hw/cmd/ana/command", "sim/cmd/ana/command", "sim/stop/ana", "sim/stop/ana"]
    assert [key.removeprefix("beatrix/bea/") for _, key in network.sent] == sent
    (press,) = {*network.presses}
    assert press


def test_an_emergency_stop_is_a_command_and_no_stop() -> None:
    network = Network({HW: RESTS})
    assert SentGroupStop(network.client(), ("*", "*"), emergency=True).replies() == {HW: RESTS}
    assert SentStop(network.client(), HW, emergency=True).answer() == RESTS
    assert network.sent == [("get", "beatrix/*/*/cmd/ana/command"), ("get", "beatrix/bea/hw/cmd/ana/command")]


def test_stop_reaches_all_robots_before_one_is_waited_for() -> None:
    network = Network({HW: RESTS})
    client = network.client()
    robots = [RobotBase(*place, client=client) for place in (HW, SIM)]
    robot, answer = next(stop_robots(robots))
    assert (robot.place, answer) == (HW, RESTS)
    assert [key for kind, key in network.sent if kind == "put"] == [
        "beatrix/bea/hw/stop/ana",
        "beatrix/bea/sim/stop/ana",
    ]


def test_robots_of_a_group_that_do_not_answer_are_named_with_what_to_do(positions: set[Place]) -> None:
    positions.add(("busy", "hw"))
    expected = [("hangs", "hw"), ("busy", "hw"), HW, ("other", "sim")]
    answers = SentGroupStop(Network({HW: RESTS}).client(), ("*", "hw")).answers(expected)
    assert [*answers] == [HW, ("busy", "hw"), ("hangs", "hw")]
    assert [answer.reason for answer in answers.values()] == [Reason.OK, Reason.TIMED_OUT, Reason.NODE_HANGS]
    for place in (("busy", "hw"), ("hangs", "hw")):
        assert answers[place].message.startswith(f"{place[0]} (hw)")
        assert "power off" in answers[place].message
    assert "Send STOP again" in answers["busy", "hw"].message


@pytest.mark.parametrize("reason", [Reason.TIMED_OUT, Reason.NODE_HANGS, Reason.NO_ROUTER])
def test_one_robot_that_does_not_answer_is_explained_by_the_same_sentence(
    monkeypatch: pytest.MonkeyPatch, reason: Reason
) -> None:
    def late(*_: object) -> None:
        raise NoAnswer(reason, "the message of the request")

    monkeypatch.setattr(Request, "next", late)
    answer = SentStop(Network().client(), HW).answer()
    assert answer.reason is reason
    assert ("power off" in answer.message) == (reason is Reason.TIMED_OUT)


def test_a_sentence_names_its_robot_once() -> None:
    same("stopping.a sentence names its robot once", sentence(HW, "The arms rest."))
    assert sentence(HW, "bea (hw) is online.") == "bea (hw) is online."


# -- the threads of StopSender ------------------------------------------------------------------------


class Robots:
    """Stands for what STOP sends; the answers of the places in `silent` come only after `go_on`."""

    def __init__(self) -> None:
        self.sent: queue.SimpleQueue[Place] = queue.SimpleQueue()
        self.clients: list[object] = []
        self.silent: set[Place] = set()
        self.go_on = threading.Event()
        self.may_send = threading.Event()
        self.may_send.set()
        self.sending = threading.Event()
        self.waits, self.closes, self.emergencies = 0, 0, 0
        self.error: Exception | None = None
        self.reported: queue.SimpleQueue[tuple[object, Answers]] = queue.SimpleQueue()

    def send(self, client: object, place: Place) -> None:
        self.sending.set()
        assert self.may_send.wait(PATIENCE_S)
        error, self.error = self.error, None
        if error is not None:
            raise error
        self.clients.append(client)
        self.sent.put(place)

    def answer(self, place: Place) -> Answer:
        self.waits += 1
        if place in self.silent:
            assert self.go_on.wait(PATIENCE_S)
        return RESTS

    def report(self, who: object) -> Callable[[Answers], None]:
        return lambda answers: self.reported.put((who, answers))

    def next_report(self) -> tuple[object, Answers]:
        return self.reported.get(timeout=PATIENCE_S)


@pytest.fixture
def robots(monkeypatch: pytest.MonkeyPatch) -> Robots:
    made = Robots()

    class Sent:
        def __init__(self, client: object, place: Place, *, emergency: bool, **_: object) -> None:
            self.place = place
            made.send(client, place)
            made.emergencies += emergency

        def answer(self) -> Answer:
            return made.answer(self.place)

        def close(self) -> None:
            made.closes += 1

    monkeypatch.setattr(stopping, "SentStop", Sent)
    return made


@pytest.fixture
def sender(robots: Robots) -> Iterator[StopSender]:
    made = StopSender("tested")
    yield made
    robots.may_send.set()
    robots.go_on.set()
    made.close()
    made.join(time.monotonic() + PATIENCE_S)
    assert not [thread.name for thread in threading.enumerate() if "tested-stop" in thread.name]


CLIENT = Network().client()


def test_a_press_is_sent_in_order_and_answered_for_each_place(sender: StopSender, robots: Robots) -> None:
    sender.send([CLIENT], [HW, SIM], robots.report(1), yield_s=PATIENCE_S)
    assert [robots.sent.get_nowait(), robots.sent.get_nowait()] == [HW, SIM], "sent when the call returns"
    reports = [robots.next_report() for _ in (HW, SIM)]
    assert {(who, *answers) for who, answers in reports} == {(1, HW), (1, SIM)}


def test_presses_while_an_answer_is_awaited_are_sent_and_share_the_newest_answer(
    sender: StopSender, robots: Robots
) -> None:
    robots.silent.add(HW)
    for who in range(5):
        sender.send([CLIENT], [HW], robots.report(who))
        assert robots.sent.get(timeout=PATIENCE_S) == HW
    robots.go_on.set()
    reports = [robots.next_report() for _ in range(5)]
    assert sorted(str(who) for who, _ in reports) == ["0", "1", "2", "3", "4"]
    assert all(answers == {HW: RESTS} for _, answers in reports)
    assert (robots.waits, robots.closes) in ((1, 4), (2, 3)), "each STOP is waited for or its query is closed"


def test_a_silent_robot_delays_neither_stop_nor_the_answer_of_another(
    sender: StopSender, robots: Robots
) -> None:
    robots.silent.add(HW)
    sender.send([CLIENT], [HW, SIM], robots.report(1))
    assert robots.next_report() == (1, {SIM: RESTS})
    sender.send([CLIENT], [SIM], robots.report(2))
    assert robots.next_report() == (2, {SIM: RESTS})


def test_a_flood_for_one_place_is_sent_as_one_stop_and_delays_no_other_place(
    sender: StopSender, robots: Robots
) -> None:
    robots.may_send.clear()
    sender.send([CLIENT], [HW], robots.report("first"))
    assert robots.sending.wait(PATIENCE_S)
    for number in range(1000):
        sender.send([CLIENT], [HW], robots.report(number))
    sender.send([CLIENT], [SIM], robots.report("other"))
    robots.may_send.set()
    sent = [robots.sent.get(timeout=PATIENCE_S) for _ in range(3)]
    assert sent == [HW, HW, SIM]
    assert robots.sent.empty()
    reported: list[object] = []
    while not {"first", "other"} <= {*reported}:
        reported.append(robots.next_report()[0])
    assert len({*reported}) == len(reported) <= REPORTS_MAX + 2


def test_a_stop_never_stands_for_an_emergency_stop(sender: StopSender, robots: Robots) -> None:
    robots.may_send.clear()
    robots.silent.add(HW)
    sender.send([CLIENT], [HW], robots.report("first"))
    assert robots.sending.wait(PATIENCE_S)
    sender.send([CLIENT], [HW], robots.report("emergency"), emergency=True)
    sender.send([CLIENT], [HW], robots.report("stop"))
    robots.may_send.set()
    assert [robots.sent.get(timeout=PATIENCE_S) for _ in range(3)] == [HW, HW, HW]
    robots.go_on.set()
    assert {robots.next_report()[0] for _ in range(3)} == {"first", "emergency", "stop"}
    assert robots.emergencies == 1


def test_stop_is_sent_to_more_places_than_are_awaited(sender: StopSender, robots: Robots) -> None:
    places = [(f"bea{number}", "hw") for number in range(PLACES_MAX + 4)]
    robots.silent = {*places}
    sender.send([CLIENT], places, robots.report(1))
    assert [robots.sent.get(timeout=PATIENCE_S) for _ in places] == places
    until(lambda: robots.closes == 4, "the answers of four places are not awaited")
    robots.go_on.set()
    for _ in range(PLACES_MAX):
        robots.next_report()
    robots.silent.clear()
    sender.send([CLIENT], [HW], robots.report(2))
    assert robots.next_report() == (2, {HW: RESTS})


def test_the_first_connected_session_sends(sender: StopSender, robots: Robots) -> None:
    lost, other = Network(connected=False).client(), Network().client()
    for number, clients in enumerate(([other, lost], [lost, other], [lost, lost])):
        sender.send(clients, [HW], robots.report(number))
        robots.next_report()
    assert robots.clients == [other, other, lost]


def test_an_error_is_reported_and_the_next_stop_is_sent(sender: StopSender, robots: Robots) -> None:
    robots.error = WrongUsage(Reason.SHUTDOWN, "closed")
    sender.send([CLIENT], [HW, SIM], robots.report(1))
    reports = dict(robots.next_report()[1].popitem() for _ in (HW, SIM))
    assert (reports[HW].reason, reports[SIM]) == (Reason.SHUTDOWN, RESTS)


def test_an_unexpected_error_is_shown_and_the_next_stop_is_sent(
    sender: StopSender, robots: Robots, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[BaseException | None] = []
    monkeypatch.setattr(threading, "excepthook", lambda arguments: shown.append(arguments.exc_value))
    robots.error = wrong = ValueError("unforeseen")
    sender.send([CLIENT], [HW], robots.report(1))
    sender.send([CLIENT], [SIM], lambda _: 1 / 0)
    until(lambda: len(shown) == 2, "both errors are shown")
    sender.send([CLIENT], [HW, SIM], robots.report(2))
    assert [robots.next_report()[0] for _ in (HW, SIM)] == [2, 2]
    assert shown[0] is wrong


def test_a_press_before_the_end_is_sent(robots: Robots) -> None:
    sender = StopSender("ended")
    robots.may_send.clear()
    sender.send([CLIENT], [SIM], robots.report(1))
    assert robots.sending.wait(PATIENCE_S)
    sender.send([CLIENT], [HW], robots.report(2))
    sender.close()
    robots.may_send.set()
    sender.join(time.monotonic() + PATIENCE_S)
    assert [robots.sent.get_nowait(), robots.sent.get_nowait()] == [SIM, HW]
    assert {robots.next_report()[0], robots.next_report()[0]} == {1, 2}


def test_join_waits_no_longer_than_its_deadline(robots: Robots, sender: StopSender) -> None:
    robots.silent.add(HW)
    sender.send([CLIENT], [HW], robots.report(1))
    robots.sent.get(timeout=PATIENCE_S)
    sender.close()
    sender.join(time.monotonic() + 0.05)
    assert robots.reported.empty()
