"""The simulations of all seats in one process, with the account of the teacher."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from class_router import CLI, ClassRouter
from patient_connections import PATIENCE_S, patiently
from robots import Process
from students import use_account

from beatrix_zenoh import NoAnswer, Robot
from beatrix_zenoh.client import Client
from beatrix_zenoh.settings import Settings


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    with ClassRouter(tmp_path_factory.mktemp("class")) as made:
        yield made


def robot_of(router: ClassRouter, name: str, seat: str) -> Robot:
    """Return the simulation of a name through a new session of a seat."""
    account = router.account(seat)
    client = patiently(lambda: Client(Settings(name, account.connect, seat, account=account)))
    return Robot(name, "sim", client=client, timeout_s=PATIENCE_S)


def test_the_teacher_simulates_all_seats_and_each_drives_only_its_own(
    router: ClassRouter, tmp_path: Path
) -> None:
    use_account(tmp_path, router.path("teacher"))
    process = Process(
        *CLI, "sim", "--seats", str(router.class_file), "--ready", folder=tmp_path, traced=False
    )
    try:
        process.expect_all("ready beatrix/ana/sim/", "ready beatrix/ben/sim/")
        own, of_another = robot_of(router, "ana", "ana"), robot_of(router, "ben", "ana")
        assert own.look(yaw=5).result().result
        with pytest.raises(NoAnswer):
            of_another.look(yaw=5)
        assert of_another.status().robot == "ben", "every seat may watch"
        own.client.close()
        of_another.client.close()
    finally:
        assert process.end() == 0


def test_a_seat_may_not_simulate_the_robots_of_others(router: ClassRouter, tmp_path: Path) -> None:
    use_account(tmp_path, router.path("ana"))
    process = Process(*CLI, "sim", "--seats", str(router.class_file), folder=tmp_path, traced=False)
    assert process.wait() == 2
    assert any("accepts only a robot of the same name" in line for line in process.lines)
