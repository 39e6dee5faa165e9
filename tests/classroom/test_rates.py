"""Limits of the router: the rate of pictures and the size of messages."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from class_router import Answering, ClassRouter, ReceivedKeys, settled

from beatrix_zenoh._generated import keys
from beatrix_zenoh.bus.access_control import LARGEST_MESSAGE, LARGEST_REQUEST

PICTURES = 50


@pytest.fixture(scope="module")
def router(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ClassRouter]:
    with ClassRouter(tmp_path_factory.mktemp("class")) as made:
        yield made


def test_each_camera_has_a_limited_rate_of_its_own_and_positions_have_none(router: ClassRouter) -> None:
    robot, ana = router.session("bea1"), router.session("ana")
    cameras = [keys.camera("bea1", "hw", eye) for eye in ("left", "right")]
    positions, marker = keys.positions("bea1", "hw"), keys.status("bea1", "hw")
    received = ReceivedKeys(ana, "beatrix/**")
    settled(ana)
    for _ in range(PICTURES):
        for key in (*cameras, positions):
            robot.put(key, b"1", "image/jpeg", priority="data")
    robot.put(marker, b"1", "text/plain", priority="data")
    found = received.until(marker)
    received.close()
    assert found.count(positions) == PICTURES
    for camera in cameras:
        assert 1 <= found.count(camera) < PICTURES / 2


def test_an_oversize_message_is_dropped(router: ClassRouter) -> None:
    robot, ana = router.session("bea1"), router.session("ana")
    large, marker = keys.positions("bea1", "sim"), keys.status("bea1", "sim")
    received = ReceivedKeys(ana, "beatrix/**")
    settled(ana)
    for key, size in ((large, LARGEST_MESSAGE + 1), (marker, LARGEST_MESSAGE // 2)):
        robot.put(key, bytes(size), "text/plain", priority="data")
    assert large not in received.until(marker)
    received.close()


def test_an_oversize_request_reaches_no_robot(router: ClassRouter) -> None:
    robot, ana = router.session("bea2"), router.session("ana")
    served = Answering(robot, keys.motion("bea2", "hw", "*"))
    settled(robot)
    own = keys.motion("bea2", "hw", "ana")
    for size in (LARGEST_REQUEST + 1, LARGEST_REQUEST // 2):
        query = ana.query(own, bytes(size), timeout_s=5.0)
        while query.next(5.0) is not None:
            pass
        query.close()
    assert served.asked == [own]
