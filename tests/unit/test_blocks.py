"""Programs of blocks: what is read and refused, what a program asks of a robot, and the same program as Python."""

from __future__ import annotations

import contextlib
import json
import time
from typing import Any

import pytest
from block_programs import Ended, Recorder, Saved, block, execute, lesson_1, number, repeat, saved, variable
from hypothesis import example, given
from hypothesis import strategies as st

from beatrix_zenoh.blocks import python, walker
from beatrix_zenoh.blocks.program import BYTES_MAX, DEPTH_MAX, STATEMENTS, VALUES, Program, WrongProgram, read
from beatrix_zenoh.client.choreography import GESTURES
from beatrix_zenoh.contract.names import ARMS

HOME = block("home")
TRUE = block("logic_boolean", {"BOOL": "TRUE"})
X = block("variables_get", variable("x"))


def calls(*blocks: Saved) -> list[tuple[object, ...]]:
    """Return what a program asks of a robot."""
    robot = Recorder()
    walker.Walker(read(saved(*blocks)), robot).run()
    return robot.calls


def arithmetic(operator: str, first: Saved | float, second: Saved | float) -> Saved:
    return block("math_arithmetic", {"OP": operator}, A=first, B=second)


def compare(operator: str, first: Saved | float, second: Saved | float) -> Saved:
    return block("logic_compare", {"OP": operator}, A=first, B=second)


def set_x(value: Saved | float) -> Saved:
    return block("variables_set", variable("x"), VALUE=value)


WAIT_X = block("wait", SECONDS=X)
IF = block("controls_if", IF0=compare("LT", X, 5), DO0=[HOME], IF1=compare("LT", X, 9), DO1=[WAIT_X], ELSE=[])
ELSE = block("controls_if", IF0=block("logic_negate", BOOL=TRUE), DO0=[HOME], ELSE=[block("wait", SECONDS=4)])


@pytest.mark.parametrize(
    ("blocks", "asked"),
    [
        ([], []),
        ([block("turn", ANGLE=20), block("nod", ANGLE=5)], [("look", 20, 0, 0, None), ("look", 20, 5, 0, None)]),
        ([block("tilt", ANGLE=9), HOME, block("nod", ANGLE=5)], [("look", 0, 0, 9, None), ("home", None), ("look", 0, 5, 0, None)]),
        ([block("speed", SPEED=30), HOME, block("arm", {"ARM": "long"}, ANGLE=7)], [("home", 30), ("arm", "long", 7, 30)]),
        ([block("gesture", {"NAME": "yes"}), block("wait", SECONDS=0.5)], [("gesture", "yes"), ("wait", 0.5)]),
        ([repeat(2, HOME)], [("home", None)] * 2),
        ([repeat(-1, HOME), repeat(0, HOME), repeat(1.6, block("wait", SECONDS=1))], [("wait", 1)] * 2),
        ([block("turn", ANGLE=9), block("gesture", {"NAME": "no"}), block("nod", ANGLE=5)], [("look", 9, 0, 0, None), ("gesture", "no"), ("look", 0, 5, 0, None)]),
        ([block("wait_stop")], [("wait", float("inf"))]),
        ([set_x(3), repeat(2, WAIT_X, block("math_change", variable("x"), DELTA=2))], [("wait", 3), ("wait", 5)]),
        ([WAIT_X], [("wait", 0)]),
        ([block("wait", SECONDS=block("position", {"PART": "yaw"}))], [("position", "yaw"), ("wait", 7)]),
        ([block("wait", SECONDS=arithmetic("POWER", 2, arithmetic("MINUS", 5, 2)))], [("wait", 8)]),
        ([block("wait", SECONDS=arithmetic("POWER", -2, 2))], [("wait", 4)]),
        ([block("controls_if", IF0=compare("GT", 5, 5), DO0=[HOME], ELSE=[WAIT_X])], [("wait", 0)]),
        ([set_x(3), {**IF, "extraState": {"elseIfCount": 1}}], [("home", None)]),
        ([set_x(7), {**IF, "extraState": {"elseIfCount": 1, "hasElse": True}}], [("wait", 7)]),
        ([ELSE], [("wait", 4)]),
        ([block("controls_whileUntil", {"MODE": "UNTIL"}, BOOL=compare("GTE", X, 2), DO=[HOME, block("math_change", variable("x"), DELTA=1)])], [("home", None)] * 2),
        ([{**HOME, "disabledReasons": ["MANUALLY_DISABLED"]}], []),
    ],
)  # fmt: skip
def test_what_a_program_and_its_python_ask_of_the_robot(
    blocks: list[Saved], asked: list[tuple[object, ...]]
) -> None:
    executed = Recorder()
    execute(python.text(read(saved(*blocks))), executed)
    assert calls(*blocks) == executed.calls == asked


def test_each_round_of_a_loop_pauses() -> None:
    robot = Recorder()
    walker.Walker(read(saved(repeat(3))), robot).run()
    assert robot.rounds == 3


@pytest.mark.parametrize(
    ("blocks", "key", "at"),
    [
        ([block("shell")], "unknown", "shell-id"),
        ([number(1)], "unknown", "number-id"),
        ([block("wait", SECONDS=HOME)], "unknown", "home-id"),
        ([block("turn")], "gap", "turn-id"),
        ([{**IF, "extraState": {"elseIfCount": 10**12}}], "gap", "controls_if-id"),
        ([block("arm", {"ARM": "left"}, ANGLE=1)], "format", "arm-id"),
        ([block("gesture", {"NAME": "../../etc/passwd"})], "format", "gesture-id"),
        ([block("variables_set", {"VAR": {"id": "?"}}, VALUE=1)], "format", "variables_set-id"),
        ([block("wait", SECONDS=1e10)], "large", "number-id"),
        ([block("wait", SECONDS=-1)], "time", "wait-id"),
        ([block("wait", SECONDS=arithmetic("DIVIDE", 1, 0))], "zero", "math_arithmetic-id"),
        ([block("wait", SECONDS=arithmetic("POWER", 1e9, 1e9))], "large", "math_arithmetic-id"),
        ([block("wait", SECONDS=arithmetic("POWER", -8, 0.5))], "large", "math_arithmetic-id"),
        ([set_x(1e9), repeat(2, block("math_change", variable("x"), DELTA=1e9))], "large", "math_change-id"),
        ([block("wait", SECONDS=TRUE)], "number", "logic_boolean-id"),
        ([set_x(TRUE), block("math_change", variable("x"), DELTA=1)], "number", "math_change-id"),
        ([block("controls_if", IF0=3, DO0=[HOME])], "condition", "number-id"),
    ],
)  # fmt: skip
def test_a_refusal_names_the_block_and_what_to_do(blocks: list[Saved], key: str, at: str) -> None:
    with pytest.raises(WrongProgram) as refused:
        calls(*blocks)
    assert (refused.value.key, refused.value.block) == (key, at)


@pytest.mark.parametrize(
    ("text", "key"),
    [
        *((text, "format") for text in ("", "nul", "[", '{"a"}', "[]", '"', '{"blocks": 1}', "1 2", "}")),
        ('{"blocks": {"blocks": [{"type": "home"}]}}', "starts"),
        ('{"blocks": {"blocks": [{"type": "start"}, {"type": "start"}]}}', "starts"),
        ("[" * BYTES_MAX, "format"),
        (" " * BYTES_MAX + " ", "size"),
        ('{"a":' * 13000, "format"),
    ],
)
def test_a_text_that_is_no_program_is_refused(text: str, key: str) -> None:
    with pytest.raises(WrongProgram) as refused:
        read(text)
    assert refused.value.key == key


def test_blocks_inside_each_other_have_a_limit_within_that_of_python() -> None:
    inner = [HOME]
    for _ in range(DEPTH_MAX - 1):
        inner = [repeat(1, *inner)]
    assert calls(*inner) == [("home", None)]
    execute(python.text(read(saved(*inner))), Recorder())
    with pytest.raises(WrongProgram, match="inside each other"):
        read(saved(repeat(1, *inner)))


def test_a_long_row_of_blocks_is_read_and_carried_out() -> None:
    many = 1900  # as many as fit
    text = (
        '{"blocks":{"blocks":[{"type":"start"'
        + ',"next":{"block":{"type":"home"' * many
        + "}}" * many
        + "}]}}"
    )
    program = read(text)
    assert (len(text) < BYTES_MAX, len(program.blocks)) == (True, many)
    robot = Recorder(5000)
    longer = Program(program.blocks[:1] * 5000, {})
    walker.Walker(longer, robot).run()
    assert len(robot.calls) == len(python.text(longer).splitlines()) - 5 == 5000


# -- the same as Python ------------------------------------------------------------------------------


def test_lesson_1_as_python() -> None:
    text = python.text(read(lesson_1()))
    assert text.startswith(
        "from beatrix_zenoh import Robot\n\nrobot = Robot()\nrobot.make_ready()\n\nyaw = pitch = 0\n\n"
        "for _ in range(2):\n    pitch = 15\n    robot.look(yaw=yaw, pitch=pitch)\n    pitch = -5\n"
    )


NUMBERS = st.one_of(st.integers(-9, 9), st.sampled_from([0.5, 2.25, -1e-7]))
NUMERIC: st.SearchStrategy[Any] = st.recursive(
    NUMBERS | st.sampled_from(["x", "y"]).map(lambda name: block("variables_get", variable(name)))
    | st.sampled_from(["yaw", "long"]).map(lambda part: block("position", {"PART": part})),
    lambda inner: st.builds(arithmetic, st.sampled_from(["ADD", "MINUS", "MULTIPLY", "DIVIDE"]), inner, inner)
    | st.builds(lambda value: arithmetic("POWER", value, 2), inner),
    max_leaves=4,
)  # fmt: skip
CONDITIONS: st.SearchStrategy[Any] = st.recursive(
    st.builds(compare, st.sampled_from(["EQ", "NEQ", "LT", "LTE", "GT", "GTE"]), NUMERIC, NUMERIC) | st.just(TRUE),
    lambda inner: st.builds(lambda op, a, b: block("logic_operation", {"OP": op}, A=a, B=b), st.sampled_from(["AND", "OR"]), inner, inner)
    | st.builds(lambda a: block("logic_negate", BOOL=a), inner),
    max_leaves=3,
)  # fmt: skip
LEAVES: st.SearchStrategy[Any] = st.one_of(
    st.sampled_from([HOME, block("wait_stop"), *(block("gesture", {"NAME": name}) for name in GESTURES[:2])]),
    st.builds(lambda kind, angle: block(kind, ANGLE=angle), st.sampled_from(["turn", "nod", "tilt"]), NUMERIC),
    st.builds(lambda arm, angle: block("arm", {"ARM": arm}, ANGLE=angle), st.sampled_from(ARMS), NUMERIC),
    st.builds(lambda value: block("speed", SPEED=value), NUMERIC),
    st.builds(lambda value: block("wait", SECONDS=value), NUMERIC),
    st.builds(lambda name, value: block("variables_set", variable(name), VALUE=value), st.sampled_from("xy"), NUMERIC),
    st.builds(lambda name, value: block("math_change", variable(name), DELTA=value), st.sampled_from("xy"), NUMERIC),
)  # fmt: skip


def controls(rows: st.SearchStrategy[list[Saved]]) -> st.SearchStrategy[Any]:
    """Return blocks around others; each round of a loop without an end asks for something."""
    full = rows.map(lambda blocks: [*blocks, HOME])
    return st.one_of(
        st.builds(lambda times, inner: block("controls_repeat_ext", TIMES=times, DO=inner), NUMBERS, rows),
        st.builds(lambda inner: block("forever", DO=inner), full),
        st.builds(lambda mode, test, inner: block("controls_whileUntil", {"MODE": mode}, BOOL=test, DO=inner), st.sampled_from(["WHILE", "UNTIL"]), CONDITIONS, full),
        st.builds(lambda test, one, other: block("controls_if", IF0=test, DO0=one, ELSE=other), CONDITIONS, rows, rows),
    )  # fmt: skip


BLOCKS = st.recursive(LEAVES, lambda inner: LEAVES | controls(st.lists(inner, max_size=3)), max_leaves=6)


@given(blocks=st.lists(BLOCKS, max_size=5))
def test_the_python_of_a_program_asks_for_the_same(blocks: list[Saved]) -> None:
    program = read(saved(*blocks))
    walked, executed = Recorder(), Recorder()
    refused = ""
    try:
        walker.Walker(program, walked).run()
    except Ended:
        pass
    except WrongProgram as error:
        refused = error.key
    if refused == "large":  # Python would go on, with numbers that fill the memory
        return
    with contextlib.suppress(Ended, ZeroDivisionError):
        execute(python.text(program), executed)
    assert (executed.calls[: len(walked.calls)] if refused else executed.calls) == walked.calls


@given(names=st.lists(st.text(max_size=5), unique=True, max_size=5))
@example(["speed", "speed_", "for", "1", "", "_", "½", "x²", "x2", "grüß mich", "__debug__", "yaw", "None"])
def test_variables_with_any_names_are_kept_apart_in_python(names: list[str]) -> None:
    shown = [block("wait", SECONDS=block("variables_get", variable(name))) for name in names]
    given = [block("variables_set", variable(name), VALUE=i) for i, name in enumerate(names)]
    program = read(saved(*given, block("home"), *shown, variables=names))
    robot = Recorder()
    execute(python.text(program), robot)
    assert robot.calls == [("home", None), *(("wait", i) for i in range(len(names)))]


WORDS = st.sampled_from([*STATEMENTS, *VALUES, "start", "NUM", "x", ""])
JUNK = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=3) | WORDS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(WORDS, inner, max_size=3),
    max_leaves=6,
)


@st.composite
def damaged(draw: st.DrawFn) -> str:
    """A program in which some parts are replaced by any values of JSON."""
    whole = json.loads(saved(*draw(st.lists(BLOCKS, min_size=1, max_size=4))))
    for _ in range(draw(st.integers(1, 3))):
        place = whole
        while isinstance(place, dict | list) and place:
            keys = sorted(place) if isinstance(place, dict) else range(len(place))
            key = draw(st.sampled_from(keys))
            if not isinstance(place[key], dict | list) or draw(st.integers(0, 9)) == 0:
                place[key] = draw(JUNK)
                break
            place = place[key]
    return json.dumps(whole)


@given(text=damaged() | JUNK.map(json.dumps) | st.text(max_size=40))
def test_any_text_runs_or_is_refused_with_a_sentence(text: str) -> None:
    began_s, sentence = time.process_time(), "."
    try:
        program = read(text)
        python.text(program)
        walker.Walker(program, Recorder()).run()
    except Ended:
        pass
    except WrongProgram as error:
        sentence = error.message
    assert sentence.endswith(".")
    assert time.process_time() - began_s < 1


def test_quotes_without_an_end_are_refused_at_once() -> None:
    began_s = time.process_time()
    with pytest.raises(WrongProgram):
        read('"' + '\\"' * 30_000)
    assert time.process_time() - began_s < 1.0, "the server's loop would wait"
