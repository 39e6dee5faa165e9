"""Two classes on several computers: each computer reaches the router only, and the classes are separate."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import pytest
from class_router import CLI, ClassRouter, process_of, use_account
from robots import Process
from school_network import LISTENING, Host, School, sockets
from students import PROGRAM, Seat

from beatrix_zenoh.classroom.router_file import Part

pytestmark = pytest.mark.long("several computers in network namespaces")

CONNECT = "__import__('socket').create_connection(('{}', {}), 5)"
MULTICAST = "__import__('socket').socket(2, 2).sendto(b'x', ('224.0.0.224', 7446))"


@dataclass
class Lesson:
    """Class 8a with the robots bea1 and bea2, class 8b with a robot bea1, and their seats."""

    school: School
    routers: dict[str, ClassRouter]
    hosts: dict[str, Host]
    """computers of robots and seats by name and class"""
    seats: dict[str, Seat]

    @property
    def processes(self) -> list[Process]:
        """All processes of robots and seats."""
        return [process for host in self.hosts.values() for process in host.processes]


@pytest.fixture(scope="module")
def lesson(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lesson]:
    """Both routers run on one computer, at two ports; each robot and each seat has a computer of its own."""
    with School(tmp_path_factory.mktemp("school")) as school:
        routers = {
            name: ClassRouter(
                tmp_path_factory.mktemp(name),
                inside=school.router.inside,
                name=name,
                address=school.address,
            )
            for name in ("8a", "8b")
        }
        made = Lesson(school, routers, {}, {})
        try:
            for place in ("bea1 8a", "bea2 8a", "bea1 8b"):
                computer(made, place).start(*CLI, "hw", "--port", "virtual:")
            for place in ("ana 8a", "ben 8a", "ana 8b"):
                made.seats[place] = Seat(computer(made, place).start(PROGRAM, listens=True))
            for process in made.processes:
                process.expect("ready")
            yield made
        finally:
            school.close()
            for router in routers.values():
                router.close()


def computer(lesson: Lesson, place: str) -> Host:
    """Create a computer whose programs use the account of a place: a name and a class, such as `ana 8a`."""
    name, class_name = place.split()
    lesson.hosts[place] = lesson.school.host(place)
    use_account(lesson.hosts[place].folder, lesson.routers[class_name].path(name))
    return lesson.hosts[place]


def test_seats_of_a_class_reach_and_stop_its_robots_and_no_others(lesson: Lesson) -> None:
    ana, ben, other = (lesson.seats[place] for place in ("ana 8a", "ben 8a", "ana 8b"))
    for seat in (ana, ben):
        assert seat.does("client().bus.robots(PATIENCE_S)") == [("bea1", "hw"), ("bea2", "hw")]
    assert other.does("client().bus.robots(PATIENCE_S)") == [("bea1", "hw")]
    ana.does("ready('bea1')")
    ana.does("begin('bea1', 20, 60)")
    other.does("stop_all()")  # of its own class
    ana.until("yaw('bea1') == 20", "arrived")
    assert other.does("yaw('bea1')") == 0, "the robot of the same name in the other class does not move"
    assert "ana drives this robot" in ben.refused("begin('bea1', 0)")


def test_only_the_routers_listen_and_no_program_sends_datagrams(lesson: Lesson) -> None:
    for process in lesson.processes:
        found = sockets(process.pid)
        assert found, "the program is connected"
        assert {table for table, _ in found} <= {"tcp", "tcp6"}, "neither multicast nor a name service"
        assert LISTENING not in {state for _, state in found}
    for router in lesson.routers.values():
        for part in Part:
            found = sockets(process_of(router, part))
            assert found.count(("tcp", LISTENING)) == 1
            assert {table for table, _ in found} == {"tcp"}


def test_computers_are_isolated_from_each_other(lesson: Lesson) -> None:
    if not lesson.school.isolated:
        assert "refused" in lesson.seats["ana 8a"].refused(CONNECT.format("127.0.0.1", 7446))
        return  # without namespaces, the programs of all these computers run on this one
    for place, seat in lesson.seats.items():
        for other, host in lesson.hosts.items():
            if other != place:
                assert "unreachable" in seat.refused(CONNECT.format(host.address, 7447)), (place, other)
        assert "unreachable" in seat.refused(MULTICAST)
