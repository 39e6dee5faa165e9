"""The sequence editor: the choreographies and programs that it opens and saves."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from gui_worlds import LEFT, NOD, UP, editing, refusal_of, world

from beatrix_zenoh.client.choreography import choreography
from beatrix_zenoh.client.motion_file import parse
from gui.console.state.actions import WriteFile
from gui.console.state.intents import Choose, DeletePose, OpenSequence, SaveSequence
from gui.console.state.saved import SavedPose
from gui.console.state.sequence import POSES_MAX
from gui.console.state.state import State

THREE = (NOD, LEFT, UP)
HEAD, ARMS = "t_s,yaw_deg,pitch_deg,roll_deg", "t_s,short_deg,middle_deg,long_deg,speed_deg_s"


def written(state: State, intent: SaveSequence) -> str:
    (write,) = state.handle(intent, world())
    assert isinstance(write, WriteFile)
    return str(write.content)


@pytest.mark.parametrize(
    ("text", "trouble", "english", "german"),
    [
        ("speed\n1\n", "", "line 1: 'speed' is not a column", "Zeile 1 von dance.csv passt nicht"),
        (f"{HEAD},speed_deg_s\n1,0,0,0,20\n0,0,0,0,20\n", "", "line 3", "Zeile 3 von dance.csv"),
        ("", "", "begin with the names of the columns", "dance.csv ist keine Bewegungsdatei"),
        (f"{HEAD}\n1,0,0,0\n", "", "so it is a path", "ist also ein Pfad"),
        (f"{HEAD},speed_deg_s\n1,0,0,0,\n", "", "line 2: speed_deg_s is empty", "Zeile 2 von dance.csv"),
        ("", "Permission denied", "dance.csv cannot be opened", "dance.csv"),
        (f"{HEAD},speed_deg_s\n0,0,89,0,30\n", "", "lean", "Kopf"),
        (ARMS + "".join(f"\n{row},0,0,0,30" for row in range(POSES_MAX + 1)), "", "has 101 poses", "101"),
    ],
)
def test_a_file_that_is_no_sequence_is_explained_and_the_strip_stays(
    text: str, trouble: str, english: str, german: str
) -> None:
    state = editing(*THREE)
    for code, words in (("en", english), ("de", german)):
        state.handle(Choose("language", code), world())
        state.handle(OpenSequence(Path("dance.csv"), text, trouble), world())
        assert words in refusal_of(state)
    assert state.saved.poses == THREE


def test_a_saved_choreography_is_opened_as_the_same_sequence() -> None:
    state = editing(*THREE)
    text = written(state, SaveSequence(Path("dance.csv")))
    assert [step.at for _, step in choreography(parse(text, "dance.csv")).steps] == [0.0, 2.0, 3.5]
    state.handle(DeletePose("nod"), world())
    state.handle(OpenSequence(Path("dance.csv"), text), world())
    assert state.saved.poses == THREE


@pytest.mark.parametrize("loop", [False, True])
def test_a_saved_program_contains_the_motions(loop: bool) -> None:
    state = editing(*THREE, SavedPose("a\nb", *UP.arms, 2.5))
    state.handle(Choose("loop", value=loop), world())
    text = written(state, SaveSequence(Path("dance.py"), program=True))
    calls = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)]
    steps = [call for call in calls if isinstance(call.func, ast.Name) and call.func.id == "ArmPose"]
    goals = [tuple(ast.literal_eval(argument) for argument in call.args[1:4]) for call in steps]
    assert goals == [*(pose.arms for pose in THREE), UP.arms] * (2 if loop else 1)
    assert text.splitlines()[2] == "from beatrix_zenoh import Twin"
    assert ("while True" in text) is loop
