"""The choice of another router or account: checked first, so that a wrong choice never costs a working connection."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from beatrix_zenoh import account as accounts
from beatrix_zenoh import bus as zbus
from beatrix_zenoh import settings as resolved
from beatrix_zenoh.contract import names
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError, WrongUsage
from beatrix_zenoh.settings import Settings
from gui.console.link.connection import Connection
from gui.console.link.jobs import Jobs
from gui.console.state.actions import UseAccount, UseRouter
from gui.console.state.connecting import refusal
from gui.console.state.world import LinkPhase, Trouble


class Routers:
    """Checks choices one after the other, and makes the connection use those that are possible."""

    def __init__(self, jobs: Jobs, connection: Connection, leave: Callable[[], None]) -> None:
        """Store the arguments; `leave` ends what this link does at the present router, and must not wait."""
        self._jobs, self._connection, self._leave = jobs, connection, leave
        self.busy = False
        """whether a choice is being checked"""
        self.trouble: Trouble | None = None
        """why the last choice is not used; None: it is, or there was none"""

    def choose(self, action: UseRouter | UseAccount) -> None:
        """Check the choice, and use it if it is possible; returns at once."""
        self.busy, self.trouble = True, None
        self._jobs.put("routers", lambda: self._check(action))

    # -- one after the other -----------------------------------------------------------------------

    def _check(self, action: UseRouter | UseAccount) -> None:
        try:
            if isinstance(action, UseRouter):
                self.trouble = self._use(action.address)
            else:
                self.trouble = self._join(action.file)
        finally:
            self.busy = False

    def _use(self, endpoint: str) -> Trouble | None:
        """Use the router at an endpoint, with the account of this computer if it is of that router."""
        try:
            for one in zbus.endpoints(endpoint):
                zbus.parse_endpoint(one)
        except WrongUsage as error:
            return Trouble("connect.bad_address", detail=error.message, slots={"address": endpoint})
        try:
            account = resolved.account_at(endpoint)
        except WrongUsage as error:
            return Trouble("connect.bad_account", detail=error.message)
        now = self._connection.settings
        if account is not None:
            who = account.name
        else:
            who = now.who if now.account is None else names.default_seat()
        return self._change(replace(now, connect=endpoint, who=who, account=account))

    def _join(self, file: Path) -> Trouble | None:
        """Use router and seat of an account file, and store it as `beatrix join` does."""
        try:
            account = accounts.load(file)
        except WrongUsage as error:
            key = "connect.not_account" if file.is_file() else "connect.no_file"
            return Trouble(key, detail=error.message, slots={"file": file.name})
        now = self._connection.settings
        robot = account.robot or now.robot
        chosen = replace(now, connect=account.connect, who=account.name, account=account, robot=robot)
        try:
            return self._change(chosen, store=True)
        except OSError as error:
            return Trouble("connect.not_stored", detail=str(error), slots={"file": str(accounts.joined())})

    def _change(self, settings: Settings, *, store: bool = False) -> Trouble | None:
        """Use these settings, and store their account; raises OSError if it cannot be stored.

        A router that does not answer is used only if there is no connection to lose.
        """
        account, error = settings.account, _refusal(settings)
        works = self._connection.phase is LinkPhase.ONLINE
        if error is not None and (works or error.reason is not Reason.NO_ROUTER):
            return _trouble(error, settings)
        if store and account is not None:
            accounts.store(account)
        self._leave()
        self._connection.change(settings, name_given=account is not None and bool(account.robot))
        return None


def _refusal(settings: Settings) -> BeatrixError | None:
    """Return why a router does not accept these settings; None if it does."""
    try:
        with zbus.connect(settings.connect, label=settings.who, account=settings.account) as bus:
            return bus.refusal()
    except BeatrixError as error:
        return error


def _trouble(error: BeatrixError, settings: Settings) -> Trouble:
    if error.reason is Reason.NO_ROUTER:
        return Trouble("connect.unanswered", detail=error.message, slots={"endpoint": settings.connect})
    key, slots = refusal(settings.connect, settings.account, accounts.today())
    return Trouble(key, detail=error.message, slots=slots)
