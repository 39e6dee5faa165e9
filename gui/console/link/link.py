"""The link of the window: passes actions to the parts that carry them out, and assembles the `World`."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Never, TypeVar

from beatrix_zenoh.client.stopping import StopSender
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.messages import Reason, Source
from beatrix_zenoh.contract.names import SIDES
from beatrix_zenoh.settings import Settings
from gui.console.link.block_run import BlockRun
from gui.console.link.children import HARDWARE, SIMULATION, Children, Ports, Recordings
from gui.console.link.choreographies import Playing
from gui.console.link.connection import PROBE_S, PROBE_SHARED_S, Connection, Probe, Session
from gui.console.link.editor import Editor
from gui.console.link.filming import Filming
from gui.console.link.governing import LessonReports, robots_online, send_govern
from gui.console.link.jobs import Jobs
from gui.console.link.lesson_runs import LessonRuns
from gui.console.link.moving import Moving, RobotAction
from gui.console.link.outcomes import WindowError, failed, stopped, write
from gui.console.link.own_gestures import OwnGestures
from gui.console.link.pictures import Camera, CameraStream, LevelStream, OnImage, Watcher, levels
from gui.console.link.routers import Routers
from gui.console.link.stopping import send_stop
from gui.console.state import actions
from gui.console.state.actions import Action, Outcome, SendStop
from gui.console.state.world import World

Shared = actions.ShareGesture | actions.FetchGestures
A = TypeVar("A", bound=RobotAction | actions.Govern | actions.Hold | SendStop | Shared)
OnOutcome = Callable[[Outcome], None]
CLOSE_S = 2.8
"""Time limit for threads and processes to end; slower threads and processes end by themselves afterwards."""


class Link:
    """The window's connection to router and robots; no method except `close` waits for either of them."""

    def __init__(
        self,
        settings: Settings,
        on_outcome: OnOutcome,
        on_image: OnImage,
        *,
        name_given: bool = True,
        source: Source = Source.WINDOW,
        shared: Session | None = None,
        gestures: tuple[Path, ...] = (),
    ) -> None:
        """Create the link; nothing is connected yet.

        Args:
            settings: robot, router and seat to begin with.
            on_outcome: called on threads of the link; must return at once.
            on_image: called in the same way, for each picture of a camera.
            name_given: whether the user chose the robot; otherwise the link selects the only name online, or for the
                teacher one of several.
            source: the face, for the events of robots.
            shared: a session whose states of robots and seats this link reads; None: it receives them itself.
            gestures: the folder of the seat's own gestures, besides the common ones; none: that of the user.
        """
        self._on_outcome, self._on_image, self._default_seat = on_outcome, on_image, names.default_seat()
        jobs, report = Jobs("window"), self._report
        self._jobs = jobs
        self._cameras = Watcher[Camera, CameraStream]("cameras", jobs, lambda: self.session, self._see)
        self._levels = Watcher[str, LevelStream]("levels", jobs, lambda: self.session, self._hear)
        self._connection = Connection(
            settings, jobs, self._follow, name_given=name_given, source=source, shared=shared
        )
        self.moving = Moving(jobs, report, gestures)
        self._editor, self._stop_sender = Editor(), StopSender("window")
        self._lessons, self._gestures = LessonReports(jobs), OwnGestures(jobs, report, gestures)
        period_s = PROBE_S if shared is None else PROBE_SHARED_S
        self._probes = {side: Probe(side, jobs, period_s) for side in SIDES}
        self._looks = (
            lambda _, now_s: self._connection.look(now_s),
            *(probe.look for probe in self._probes.values()),
            *(self._lessons.look, self.moving.person.look),
        )
        """what asks robots again when it is time"""
        self._children = Children(jobs, self._connection.try_now)
        self._recordings, self._ports = Recordings(jobs), Ports(jobs)
        self._filming = Filming(jobs, lambda: self.session)
        self._routers = Routers(jobs, self._connection, self.moving.deselect)
        self._lesson_runs = LessonRuns(jobs)
        if source is Source.WINDOW:  # no page shows them
            self._looks = (*self._looks, lambda _, now_s: self._lesson_runs.look(now_s))
        self._table = self._carrying_out()

    def look(self) -> None:
        """Look for the router, and for a robot, if it is time; `world` does this, too."""
        self._connection.look(time.monotonic())

    @property
    def session(self) -> Session | None:
        """The session with the router; None until a router answers."""
        return self._connection.session

    def names(self) -> tuple[str, ...]:
        """Return the names of the robots online, sorted."""
        return self._connection.names()

    def world(self, robot: str = "") -> World:
        """Return the present world, by default of the selected robot; call it in one thread only, for a window Qt's."""
        connection, moving, program = self._connection, self.moving, self.moving.program
        play = program if isinstance(program, Playing) else None
        latency_s = {} if robot else {side: probe.round_trip_s for side, probe in self._probes.items()}
        (sim, hw), now_s = connection.states(robot := robot or connection.robot), time.monotonic()
        session, settings, account = connection.session, connection.settings, connection.settings.account
        for look in self._looks:
            look(session, now_s)
        return World(
            now_s=now_s,
            phase=connection.phase,
            endpoint=settings.connect,
            seat=settings.who,
            who="" if settings.who == (account.name if account else self._default_seat) else settings.who,
            robot=robot,
            sim=sim,
            hw=hw,
            names=connection.names(),
            trouble=connection.trouble,
            latency_s=latency_s,
            plan=moving.plan,
            recording=self._recordings.progress(),
            picture=self._filming.progress(),
            music=moving.sounds.progress(),
            starting=self._children.starts(SIMULATION),
            connecting=self._children.starts(HARDWARE),
            own_hardware=self._children.runs(HARDWARE),
            ports=self._ports.newest,
            child_trouble=self._children.trouble,
            account=settings.account,
            choosing=self._routers.busy,
            router_trouble=self._routers.trouble,
            playing="" if play is None else play.title,
            playing_pose=-1 if play is None else play.pose,
            block=program.block if isinstance(program, BlockRun) else None,
            gestures=self._gestures.newest(now_s),
            program=moving.python(now_s),
            code=self._editor.progress(now_s),
            wall_s=time.time(),
            session="" if session is None else session.client.bus.session_id,
            limits=self._probes["sim"].limits(robot) or self._probes["hw"].limits(robot),
            seats=() if session is None else tuple(session.seats.names()),
            robots=robots_online(session) if self._lessons.watched else (),
            reports=self._lessons.rows,
            reports_failed=self._lessons.failed,
            lesson=self._lesson_runs.newest,
            levels=levels(self._levels.open),
            person=moving.person.newest,
        )

    def do(self, action: Action) -> None:
        """Carry out an action; its results are reported as `Outcome`s."""
        self._table[type(action)](action)  # type: ignore[arg-type]  # each function takes actions of this class

    def _carrying_out(self) -> Mapping[type[Action], Callable[[Never], None]]:
        """Return what carries out the actions of each class."""
        moving, connection, children, online = self.moving, self._connection, self._children, self._online
        motions = (actions.Send, actions.Play, actions.RunBlocks)
        requests = (*motions, actions.SendCommand, actions.AskLease, actions.MakeReady)
        return {
            **dict.fromkeys(requests, online(self._request)),
            SendStop: self._stop,
            actions.SendNow: lambda _: moving.send_now(),
            actions.Abort: lambda _: moving.abort(),
            actions.Hold: online(lambda action, session: moving.hold(action, session.twin)),
            actions.Release: lambda action: moving.release(action.row),
            actions.Retry: lambda _: connection.try_now(),
            actions.ChooseRobot: lambda action: self._select(action.name),
            actions.Watch: self._watch,
            actions.UseSounds: moving.sounds.use,
            actions.MovePerson: moving.person.move,
            actions.LetSpeak: lambda action: moving.person.speak(on=action.on),
            actions.Govern: online(self._govern),
            actions.BeginRecording: lambda _: self._recordings.begin(*connection.where),
            actions.EndRecording: lambda _: self._recordings.end(),
            actions.ViewRecording: lambda action: children.view(action.file),
            actions.TakePicture: self._filming.take,
            actions.EndFilm: lambda _: self._filming.end(),
            actions.OpenPicture: lambda action: self._filming.open(action.file),
            actions.StartSimulation: lambda _: children.simulate(*connection.where),
            actions.LookForPorts: lambda _: self._ports.look(),
            actions.ConnectHardware: lambda action: children.connect(*connection.where, action.port),
            actions.UseRouter: self._routers.choose,
            actions.UseAccount: self._routers.choose,
            actions.EndBlocks: lambda _: moving.end_blocks(),
            actions.RunProgram: self._run,
            actions.EndProgram: lambda _: moving.end_program(),
            actions.OpenProgram: self._editor.open,
            actions.WriteProgram: self._editor.write,
            actions.WriteFile: self._write,
            actions.KeepGesture: self._gestures.keep,
            **dict.fromkeys((actions.ShareGesture, actions.FetchGestures), online(self._gestures.exchange)),
            actions.RunLesson: self._lesson_runs.do,
        }

    def _see(self, session: Session, eye: Camera) -> CameraStream:
        return CameraStream(session.client, (session.twin.name, *eye), self._on_image)

    def _hear(self, session: Session, side: str) -> LevelStream:
        return LevelStream(session.client, (session.twin.name, side))

    def _watch(self, action: actions.Watch) -> None:
        self._lessons.watch(on=action.class_page)
        self._cameras.watch(action.cameras)
        self._levels.watch(action.microphones)
        self.moving.person.watch(on=action.person)

    def _follow(self) -> None:
        """Receive pictures and levels of the present session's robots from now on."""
        self._cameras.restart()
        self._levels.restart()

    def _select(self, robot: str) -> None:
        if robot != self._connection.robot:
            self.moving.deselect()
        self._connection.select(robot)

    def _write(self, action: actions.WriteFile) -> None:
        self._jobs.put("files", lambda: self._report(write(action)))

    def _report(self, outcome: Outcome) -> None:
        """Report an outcome on a thread of the link, in the order of the calls."""
        self._jobs.put("outcomes", lambda: self._on_outcome(outcome))

    def _govern(self, action: actions.Govern, session: Session) -> None:
        self._jobs.put("class", lambda: send_govern(action, session, self._report))

    def _request(self, action: RobotAction, session: Session) -> None:
        """Carry out an action that robots answer."""
        self.moving.request(action, session.twin)

    def _run(self, action: actions.RunProgram) -> None:
        settings = replace(self._connection.settings, robot=self._connection.robot)
        self.moving.run_program(action, settings)

    # -- STOP ---------------------------------------------------------------------------------------

    def _stop(self, action: SendStop) -> None:
        self._online(partial(send_stop, self._stop_sender, report=self._report))(action)
        self.drop()  # in this thread, so that requests made after STOP are not dropped

    def _online(self, carry_out: Callable[[A, Session], None]) -> Callable[[A], None]:
        """Return a function that carries an action out; without a session it reports why the request failed."""

        def do(action: A) -> None:
            session = self._connection.session
            if session is not None:
                carry_out(action, session)
            else:
                self._report(failed(action.row, "", self._connection.missing))

        return do

    def drop(self) -> None:
        """Drop waiting requests, and end plans, plays, programs and the person's voice, because STOP was pressed."""
        self.moving.drop(stopped())
        self.moving.person.speak(on=False)
        self._lesson_runs.end()

    # -- the end ------------------------------------------------------------------------------------

    def close(self) -> None:
        """Stop the motions of this window, close the session and end all children; takes at most 3 s."""
        deadline_s = time.monotonic() + CLOSE_S
        self.moving.drop(WindowError(Reason.SHUTDOWN, "result.closed"))
        self._lesson_runs.end()
        for part in (self._stop_sender, self._cameras, self._levels, self._filming):
            part.close()
        # In parallel, because each may need all of the time, for example while a recorder completes its file.
        self._jobs.put("recorder-end", lambda: self._recordings.end_all(deadline_s))
        self._jobs.put("children-end", lambda: self._children.end_all(deadline_s))
        self._jobs.put("connection-end", self._connection.close)
        self._jobs.close()
        for threads in (self._stop_sender, self._jobs):
            threads.join(deadline_s)
