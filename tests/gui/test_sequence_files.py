"""The sequence editor: the choreographies and programs that it opens and saves."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from gui_worlds import world

from beatrix_zenoh.client.choreography import ArmPose, choreography
from beatrix_zenoh.client.motion_file import parse
from gui.console.state.actions import WriteFile
from gui.console.state.intents import Choose, DeletePose, OpenSequence, SaveSequence
from gui.console.state.saved import Saved, SavedPose
from gui.console.state.sequence import POSES_MAX
from gui.console.state.state import State
from gui.console.state.world import World

NOD = SavedPose("nod", 20.0, 0.0, 0.0, 2.0)
LEFT = SavedPose("left", 30.0, 30.0, 30.0, 1.5)
UP = SavedPose("up", 0.0, 0.0, 0.0, 1.0)
THREE = (NOD, LEFT, UP)


def editing(*poses: SavedPose) -> State:
    return State(Saved(poses=poses))


def refusal_of(state: State, now: World | None = None) -> str:
    refusal = state.view(now or world()).commands.refusal
    return "" if refusal is None else refusal.text


def written(state: State, intent: SaveSequence) -> str:
    (write,) = state.handle(intent, world())
    assert isinstance(write, WriteFile)
    return str(write.content)


@pytest.mark.parametrize(
    ("text", "english", "german"),
    [
        ("speed\n1\n", "line 1: 'speed' is not a column", "Zeile 1 von dance.csv passt nicht"),
        (
            "t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s\n1,0,0,0,20\n0,0,0,0,20\n",
            "line 3",
            "Zeile 3 von dance.csv",
        ),
        ("", "begin with the names of the columns", "dance.csv ist keine Bewegungsdatei"),
        (
            "t_s,yaw_deg,pitch_deg,roll_deg\n1,0,0,0\n",
            "so it is a path",
            "ist also ein Pfad",
        ),
        (
            "t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s\n1,0,0,0,\n",
            "line 2: speed_deg_s is empty",
            "Zeile 2 von dance.csv",
        ),
    ],
)
def test_a_file_that_is_no_choreography_is_explained_in_both_languages(
    text: str, english: str, german: str
) -> None:
    state = editing(*THREE)
    for code, words in (("en", english), ("de", german)):
        state.handle(Choose("language", code), world())
        state.handle(OpenSequence(Path("dance.csv"), text), world())
        assert words in refusal_of(state)
    assert state.saved.poses == THREE


def test_a_saved_choreography_is_opened_as_the_same_sequence() -> None:
    state = editing(*THREE)
    text = written(state, SaveSequence(Path("dance.csv")))
    steps = [step for _, step in choreography(parse(text, "dance.csv")).steps]
    assert [step.at for step in steps] == [0.0, 2.0, 3.5]
    assert all(isinstance(step, ArmPose) for step in steps)
    state.handle(DeletePose("nod"), world())
    state.handle(OpenSequence(Path("dance.csv"), text), world())
    assert [pose.name for pose in state.saved.poses] == ["nod", "left", "up"]
    assert [pose.arms for pose in state.saved.poses] == [pose.arms for pose in THREE]
    assert [pose.duration_s for pose in state.saved.poses] == [2.0, 1.5, 1.0]


@pytest.mark.parametrize("loop", [False, True])
def test_a_saved_program_contains_the_motions(loop: bool) -> None:
    state = editing(*THREE, SavedPose("a\nb", *UP.arms, 2.5))
    state.handle(Choose("loop", value=loop), world())
    text = written(state, SaveSequence(Path("dance.py"), program=True))
    calls = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
    moves = [call for call in calls if isinstance(call.func, ast.Attribute) and call.func.attr == "move"]
    goals = [tuple(ast.literal_eval(argument) for argument in call.args) for call in moves]
    assert goals == [pose.arms for pose in THREE] * (2 if loop else 1)
    assert "time.sleep(2.5)" in text
    assert text.splitlines()[2] == "import time"
    assert ("while True" in text) is loop


@pytest.mark.parametrize(
    ("text", "trouble", "sentence"),
    [
        ("t_s,yaw_deg,pitch_deg,roll_deg\n0,1,2,3\n", "", "has no column speed_deg_s"),
        ("nothing", "", "'nothing' is not a column"),
        ("", "Permission denied", "x.csv cannot be opened"),
        ("t_s,yaw_deg,pitch_deg,roll_deg,speed_deg_s\n0,0,89,0,30\n", "", "lean"),
        ("t_s,short_deg,middle_deg,long_deg,speed_deg_s\n" + "0,0,0,0,30\n", "", ""),
        (
            "t_s,short_deg,middle_deg,long_deg,speed_deg_s\n"
            + "".join(f"{number},0,0,0,30\n" for number in range(POSES_MAX + 1)),
            "",
            "has 101 poses",
        ),
    ],
)
def test_a_file_that_is_no_sequence_is_refused_and_the_strip_stays(
    text: str, trouble: str, sentence: str
) -> None:
    state = editing(*THREE)
    state.handle(OpenSequence(Path("x.csv"), text, trouble), world())
    assert sentence in refusal_of(state)
    assert (state.saved.poses == THREE) is bool(sentence)
