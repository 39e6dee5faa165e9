"""What `check.py` of a lesson uses: call functions of the pupil's program, run it, and require figures.

    def check(attempt: Attempt) -> None:
        degrees = attempt.call("degrees_per_step")
        attempt.require("step", abs(degrees - 0.086) < 0.001, value=degrees)
        seen = attempt.observe()
        nods = [size for size in swings(seen.pitch, least=2) if size >= 8]
        attempt.require("nods", len(nods) >= 4, count=len(nods))

The first figure that is not met ends the check. `hints.toml` says what each figure means. Those of `figures.toml` are
figures of every lesson; `slips` recognises some of them.
"""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext, suppress
from pathlib import Path
from typing import Self

import numpy as np
import numpy.typing as npt

from beatrix_zenoh import processes
from beatrix_zenoh.contract import tracebacks
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError
from beatrix_zenoh.lessons import bench, slips
from beatrix_zenoh.lessons.bench import Bench, Course
from beatrix_zenoh.lessons.function_child import ALARM_CODE, SLOWER, FunctionReply, plain
from beatrix_zenoh.lessons.guarded import LineChild, NoReply, Run
from beatrix_zenoh.lessons.phrases import (
    Checked,
    ErrorData,
    NotMeasurable,
    Phrase,
    Still,
    Unmet,
    busy,
    phrase,
    shown,
)
from beatrix_zenoh.lessons.program import Program
from beatrix_zenoh.lessons.sandbox import Sandbox, scratch
from beatrix_zenoh.lessons.stage import POLL_S, PUPIL, ROBOT, Seen, Stage, Stages, open_stage, pace

__all__ = ["Attempt", "NotMeasurable", "Seen", "Stage", "Unmet"]

CALL_S = 2.0
"""Longest processor time (s) of one call of a pupil's function."""
IMPORT_S = 10.0
"""Longest processor time (s) of the import of a pupil's file."""
LARGEST = 1e300
"""A number of a function beyond it is a mistake; Python has integers of any size."""
PATIENCE = 15.0
"""After this many times its limit without an answer, it is the computer that is slow."""
OWN_ERROR = re.compile(r"(\w*Error|WrongUsage)\b")
"""Errors that no busy computer causes: those of Python, such as NameError, and values that no robot was asked for."""
TAIL_S = 0.4
"""Time (s) that is observed after the end of the program."""
NO_ROUTER = "tcp/127.0.0.1:1"
"""Functions are called without robots: no router listens on this port."""


class Attempt(Checked):
    """One check of one program. Use it in a `with` block, which ends all processes that it has started."""

    def __init__(
        self,
        program: Program,
        *,
        limit_s: float,
        keep: Path | None = None,
        tell: Callable[[Phrase], None] = lambda _: None,
        stages: Stages = open_stage,
    ) -> None:
        """Prepare a check.

        Args:
            program: the pupil's program.
            limit_s: longest time of the program with a robot (s).
            keep: record the robots of a run to this file, which is overwritten; None: record nothing.
            tell: is called with sentences about a check that takes long.
            stages: runs a stage during a block, as `open_stage` does.
        """
        self.program, self._limit_s, self._keep, self._tell = program, limit_s, keep, tell
        self._stages = stages
        self._shared: Stage | None = None
        self._open = ExitStack()
        self._functions: LineChild | None = None
        self.used_s = 0.0
        """processor time (s) of the last call of a function"""

    def __enter__(self) -> Self:
        temporary = self._open.enter_context(scratch())
        self._sandbox = Sandbox(self.program, temporary)
        return self

    def __exit__(self, *_error: object) -> None:
        self._open.close()

    @contextmanager
    def on_stage(self, *robots: str) -> Iterator[None]:
        """Observe on one stage during a block, as each run leaves it, because its start takes seconds."""
        with self._stages(robots, "still", None, self._tell) as self._shared:
            yield
        self._shared = None

    # -- function -------------------------------------------------------------------------------

    def call(self, function: str, *arguments: object) -> float:
        """Return the number that a function of the pupil's file returns.

        It runs in a child process without a robot. Arguments are numbers, texts, lists, or arrays.
        Raises Unmet: `function`, `import`, `calculates`, `runs`, `ends`, or `returns` if it is not a number.
        """
        value = self.value(function, *arguments)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise Unmet("returns", function=function, value=shown(value), wanted=phrase("number"))
        if abs(value) > LARGEST:
            raise Unmet("returns", function=function, value=phrase("huge"), wanted=phrase("number"))
        return float(value)

    def call_array(
        self, function: str, *arguments: object, shape: tuple[int, ...]
    ) -> npt.NDArray[np.float64]:
        """As `call`, for a function that returns a list, tuple or array of numbers of this shape."""
        value = self.value(function, *arguments)
        try:
            found = np.array(value, dtype=float)
        except (TypeError, ValueError, OverflowError):
            found = np.array(None, dtype=float)
        if found.shape != shape or isinstance(value, str):
            wanted = phrase("array", shape=" x ".join(map(str, shape)))
            raise Unmet("returns", function=function, value=shown(value), wanted=wanted)
        return found

    def value(self, function: str, *arguments: object) -> object:
        """As `call`, for a function that returns anything that JSON can hold."""
        child = self._child()
        request = {"function": function, "arguments": [plain(one) for one in arguments], "limit_s": CALL_S}
        own = phrase("function", name=function)
        reply = _answer(lambda: child.ask(request, PATIENCE * CALL_S), CALL_S, own)
        where = self.program.where(reply.line)
        if reply.missing is not None:
            raise Unmet("function", function=function, names=", ".join(reply.missing) or phrase("none"))
        if reply.error is not None:
            if reply.error.reason is Reason.NO_ROUTER:
                raise Unmet("calculates", function=function, where=where)
            given = ", ".join(str(one) for one in arguments)
            if len(given) < 60:
                where = phrase("call", call=f"{function}({given})", where=where)
            raise Unmet(_failure(reply.error, "runs"), error=reply.error, where=where)
        if reply.odd:
            raise Unmet("returns", function=function, value=reply.odd, wanted=phrase("numbers"))
        self.used_s = reply.used_s
        return reply.value

    def _child(self) -> LineChild:
        """Return the child process that has imported the pupil's file."""
        if self._functions is None:
            words = [
                "-P",
                "-m",
                "beatrix_zenoh.lessons.function_child",
                str(self._sandbox.file),
                str(IMPORT_S),
            ]
            child = LineChild(self._sandbox, words, {"BEATRIX_CONNECT": NO_ROUTER})
            self._open.callback(child.close)
            reply = _answer(lambda: child.reply(PATIENCE * IMPORT_S), IMPORT_S, phrase("import"))
            if reply.error is not None:
                figure = "import" if reply.error.reason is Reason.NO_ROUTER else "runs"
                where = self.program.where(reply.line)
                raise Unmet(_failure(reply.error, figure), error=reply.error, where=where)
            self._functions = child
        return self._functions

    # -- bench ----------------------------------------------------------------------------------

    def bench(
        self,
        function: str,
        *,
        seconds: float,
        course: Course | None = None,
        delay_s: float = 0.0,
        result: bench.Result = "angle",
        speed: float | None = None,
    ) -> Bench:
        """Return what the head does when a function of the pupil drives it, 50 times a second in virtual time.

        The firmware and the physics are those of the simulation, many times faster than in reality.

        Args:
            function: without `course` it is called as `function(t)`, t in s; with one as `function(error, dt)`, error
                (deg) being the course minus the yaw, both `delay_s` ago, as a camera sees them, and dt = 0.02 s.
            seconds: duration (s).
            course: yaw (deg) to follow at the time t (s).
            delay_s: age (s) of the error.
            result: what the function returns: `angle`, the yaw to look at (deg); `rate`, a speed of yaw (deg/s).
            speed: of the motions (deg/s); by default that of `look`.

        Raises Unmet as `call`, and `refused` for a target that the robot refuses.
        """
        plant = bench.start(speed)

        def call(*arguments: float) -> float:
            value = self.call(function, *arguments)
            self.require(
                "returns", math.isfinite(value), function=function, value=value, wanted=phrase("number")
            )
            return value

        return bench.run(plant, call, result, seconds, course, delay_s, self._tell)

    # -- observed -------------------------------------------------------------------------------

    def observe(
        self,
        *,
        target: tuple[float, float, float] | None = None,
        path: str = "still",
        seconds: float | None = None,
        during: Callable[[Stage], None] = lambda _: None,
        robot_file: Path | None = None,
    ) -> Seen:
        """Run the program against a simulation of its own, and return what the robot did.

        Args:
            target: place of the person (m); None: its usual place.
            path: `still`, `sway` or `circle`: the path of the person.
            seconds: end the program after this time (s), as Ctrl-C does; None: it must end by itself.
            during: is called once the program runs, with the stage: it may read and move the robots as another seat,
                and wait; its exceptions end the check.
            robot_file: values of another robot, as for `beatrix sim --robot-file`.

        Raises:
            Unmet: a figure of `Run.check`, `ends` if the program does not end, one of `slips.motions` if it has ended and
                no robot was moved, or what `during` raises.
            NotMeasurable: this computer was too busy.
        """
        with self._stage((ROBOT,), path, robot_file) as stage:
            if target is not None:
                stage.watches[ROBOT].robot.move_target(*target)
            seen = self._observed(stage, during, seconds=seconds)
        if seconds is None:
            slips.motions(seen.values())
        return seen[ROBOT]

    def observe_all(
        self, *, robots: tuple[str, ...], during: Callable[[Stage], None], within_s: float
    ) -> dict[str, Seen]:
        """As `observe`, with several robots; return what each did, by name. BEATRIX_ROBOT is the first.

        The program must end `within_s` (s) after `during`, whatever time it has had before.
        """
        with self._stage(robots) as stage:
            return self._observed(stage, during, within_s=within_s)

    def _observed(
        self,
        stage: Stage,
        during: Callable[[Stage], None],
        *,
        seconds: float | None = None,
        within_s: float | None = None,
    ) -> dict[str, Seen]:
        """Run the program on a stage, and return what each robot did."""
        self.doubt = None
        environment = {
            "BEATRIX_CONNECT": stage.endpoint,
            "BEATRIX_ROBOT": stage.names[0],
            "BEATRIX_WHO": PUPIL,
            tracebacks.VARIABLE: tracebacks.DATA,
        }
        limit_s = self._limit_s if seconds is None else seconds
        with stage.recorded(self._keep) if self._keep else nullcontext():
            for watch in stage.watches.values():
                watch.begin()
            run = Run(self._sandbox, environment)
            try:
                self._tell(phrase("watches", seconds=limit_s))
                self._let(during, run, stage)
                if within_s is not None:
                    limit_s = run.seconds + within_s
                self._finish(run, stage, limit_s, ends=seconds is None)
                return self._judge(stage, run)
            except Unmet:
                with suppress(NotMeasurable):
                    self.panels = self.draw(
                        {name: one.end(run.began_ns) for name, one in stage.watches.items()}
                    )
                raise
            finally:
                run.close()
                self.cores = run.cores

    def _stage(
        self, robots: tuple[str, ...], path: str = "still", robot_file: Path | None = None
    ) -> AbstractContextManager[Stage]:
        """Return the stage of `on_stage`, or a new one."""
        return (
            nullcontext(self._shared) if self._shared else self._stages(robots, path, robot_file, self._tell)
        )

    def _judge(self, stage: Stage, run: Run) -> dict[str, Seen]:
        """Return what the robots did, and set `doubt` and `panels`; raises NotMeasurable."""
        found = {name: watch.end(run.began_ns) for name, watch in stage.watches.items()}
        self.panels = self.draw(found)
        self.doubt = next((seen.doubt for seen in found.values() if seen.doubt), None)
        return found

    @staticmethod
    def _let(during: Callable[[Stage], None], run: Run, stage: Stage) -> None:
        """Call `during`; its errors give way to that of the program, if there is one."""
        try:
            during(stage)
        except (Unmet, BeatrixError) as error:
            if not run.running:
                run.check()
                if isinstance(error, Unmet):
                    error.ended = True
            raise

    def _finish(self, run: Run, stage: Stage, limit_s: float, *, ends: bool) -> None:
        """Wait for the end of the program, and keep what the robots publish meanwhile.

        Raises Unmet, `ends`, if the program must end (`ends`) and still runs `limit_s` (s) after its start, and its
        errors; raises NotMeasurable instead if this computer may be the cause.
        """
        still = Still(self._tell, "still_runs", limit_s - run.seconds)
        while run.running and run.seconds < limit_s:
            _watch(stage, POLL_S)
            still.look()
        if run.running and ends:
            asked = pace(self._judge(stage, run))
            self.doubt = None  # short gaps do not make a program endless
            raise Unmet("ends", what=phrase("program"), limit=limit_s, **asked)
        if run.running:
            return
        try:
            run.check()
        except Unmet as unmet:
            if unmet.figure != "keyboard" and not OWN_ERROR.match(str(unmet.values["error"])):
                self._judge(stage, run)  # the robot may have stopped because this computer was busy
            raise
        _watch(stage, TAIL_S)


def _watch(stage: Stage, seconds: float) -> None:
    time.sleep(seconds)
    for watch in stage.watches.values():
        watch.take()


def _answer(ask: Callable[[], FunctionReply], limit_s: float, what: Phrase) -> FunctionReply:
    """Return an answer of the child process; without one raise Unmet, or NotMeasurable if it is still busy."""
    began_s = time.monotonic()
    try:
        return ask()
    except NoReply as error:
        if error.code is None:
            raise busy(phrase("no_answer", what=what)) from None
        if error.code == ALARM_CODE or time.monotonic() - began_s > SLOWER * limit_s:
            raise Unmet("ends", what=what, limit=limit_s) from None
        ended = phrase("ended_python", what=what, code=processes.in_words(error.code))
        raise Unmet("runs", error=ended, where="") from None


def _failure(error: ErrorData, figure: str) -> str:
    """Return `keyboard` for an error of `input()`, otherwise `figure`."""
    return "keyboard" if error.kind == "EOFError" else figure
