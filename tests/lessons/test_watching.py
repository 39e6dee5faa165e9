"""`lesson watch`: a check for each save, on a stage that is as new each time."""

from __future__ import annotations

import threading
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from unittest.mock import Mock

import pytest

from beatrix_zenoh.client.lease import ask
from beatrix_zenoh.contract._generated.messages import LeaseAction
from beatrix_zenoh.lessons import watching
from beatrix_zenoh.lessons.checking import Result, Verdict
from beatrix_zenoh.lessons.stage import PUPIL, ROBOT, Stage
from beatrix_zenoh.lessons.watching import KeptStage, watch

LONG_S = 60.0


@pytest.mark.parametrize("ends", [False, True], ids=["during a check", "after a check"])
def test_each_save_is_checked_until_the_program_passes(ends: bool, tmp_path: Path) -> None:
    program, checked = tmp_path / "start.py", list[str]()
    program.write_text("first")

    def check(path: Path, _stage: KeptStage) -> Verdict:
        checked.append(path.read_text())
        if checked[-1] == "second":
            return Verdict(Result.PASSED)
        path.write_text("second")
        if not ends:
            threading.Event().wait(LONG_S)
        return Verdict(Result.NOT_YET)

    assert watch(lambda: [program], check)
    assert checked == ["first", "second"]


def test_a_kept_stage_is_tidied_and_replaced_if_that_is_not_possible(
    stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    opens, teacher = Mock(return_value=nullcontext(stage)), stage.robot(who="teacher")
    monkeypatch.setattr(watching, "open_stage", opens)

    def opened(kept: KeptStage) -> AbstractContextManager[Stage]:
        return kept([ROBOT], "still", None, lambda _: None)

    with KeptStage() as kept:
        with opened(kept):
            pupil = stage.robot(who=PUPIL)
            pupil.look(yaw=20)
            pupil.move_target(1, 0.4, 0)
            pupil.client.close()
        with opened(kept):
            robot = stage.watches[ROBOT].robot
            assert abs(robot.positions().head.yaw) < 0.5
            assert robot.target().y == pytest.approx(0)
            assert opens.call_count == 1
            ask(teacher, LeaseAction.FREEZE)
        kept.tidy()
        ask(teacher, LeaseAction.UNFREEZE)
        with opened(kept):
            assert opens.call_count == 2
