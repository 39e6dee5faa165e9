from __future__ import annotations

import pytest

from beatrix_zenoh.bus.query_forms import RawQuery
from beatrix_zenoh.contract._generated.messages import Reason
from sim_node.target import HOME, PERIOD_S, PersonTarget, TargetPath, check, on_path, reply


@pytest.mark.parametrize("path", list(TargetPath))
def test_every_path_begins_at_home_and_stays_within_the_bounds(path: TargetPath) -> None:
    assert on_path(path, 0.0) == pytest.approx(HOME)
    assert on_path(path, PERIOD_S) == pytest.approx(HOME)
    places = [on_path(path, PERIOD_S * part / 200) for part in range(200)]
    for place in places:
        check(place)
    assert (len(set(places)) == 1) == (path is TargetPath.STILL)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (b"1 2 3", "?x=1.1;y=0.3;z=0.2"),
        (b'{"path": "there"}', "no path 'there' for the person. Choose still, sway, circle"),
        (b'{"path": "sway", "period_s": 1}', "A period of 1 s is not possible: give 2 to 600 s"),
        (b'{"path": "sway", "period_s": "nan"}', "period_s"),
        (b'{"x": 1}', "Give x, y and z (m), or a path"),
        (b'{"x": 9, "y": 0, "z": 0}', "x = 9.00 m; the room allows"),
    ],
)
def test_a_wrong_query_is_refused_with_an_explanation(wrong: bytes, words: str) -> None:
    answer = reply(PersonTarget(TargetPath.STILL, 0.0), RawQuery(wrong, "", ""), now_s=0.0)
    assert (answer.result, answer.reason) == (False, Reason.BAD_VALUE)
    assert (answer.x, answer.y, answer.z) == HOME
    assert words in answer.message


def test_a_walk_begins_when_it_is_asked_for() -> None:
    target = PersonTarget(TargetPath.STILL, 0.0)
    target.move((1.0, 1.0, 0.2))
    answer = reply(target, RawQuery(b'{"path": "sway", "period_s": 6}', "", ""), now_s=100.0)
    assert (answer.result, answer.x, answer.y, answer.z) == (True, *HOME)
    assert target.place(101.5) == pytest.approx(on_path(TargetPath.SWAY, 1.5, 6.0))
    assert target.place(101.5)[1] > 0.7, "a quarter of the way there and back"
