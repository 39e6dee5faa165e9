"""What makes robots come online: router, account, simulation, and hardware at a port that the user chooses."""

from __future__ import annotations

import datetime as dt
from pathlib import Path
from typing import Final

from beatrix_zenoh.account import Account
from beatrix_zenoh.contract._generated.messages import Fault
from beatrix_zenoh.contract.names import TEACHER
from beatrix_zenoh.settings import DEFAULT_ENDPOINT
from gui.console.state import actions
from gui.console.state.actions import Action, ConnectHardware, LookForPorts, StartSimulation
from gui.console.state.intents import Intent
from gui.console.state.memory import Handles, Memory
from gui.console.state.views import ButtonView, ConnectView, RouterView, button
from gui.console.state.world import LinkPhase, UsbPort, World, fault_of, online
from gui.console.texts import Texts

VIRTUAL: Final = "virtual:"
"""Port of the virtual robot."""
PORT: Final = DEFAULT_ENDPOINT.rpartition(":")[2]
"""Usual port of a router."""


class CloseConnect(Intent, frozen=True):
    """Hide the sheet."""


def view(memory: Memory, world: World) -> ConnectView | None:
    """Return the sheet; None while it is hidden."""
    if not memory.connecting:
        return None
    texts, failed, here = memory.choices.texts, world.child_trouble, _serves(world)
    if here:
        text = texts("connect.online", robot=world.robot)
    elif world.connecting:
        text = texts("connect.starting")
    elif failed is not None:
        text = texts(failed.key, code=failed.code)
    elif world.ports is None:
        text = texts("connect.looking")
    else:
        text = texts("connect.choose" if any(port.board for port in world.ports) else "connect.no_board")
    off = "connect.starting" if world.connecting else ""
    ports = tuple(_port(port, texts, off) for port in world.ports or ())
    virtual = button(texts, "connect.virtual", ConnectHardware(VIRTUAL), off)
    return ConnectView(
        router(world, texts),
        text,
        "" if failed is None or off else failed.detail,
        () if here or world.ports is None else (*ports, virtual),  # all at once: none moves under the mouse
        button(texts, "connect.again", LookForPorts(), off),
        button(texts, "connect.close", CloseConnect()),
    )


def router(world: World, texts: Texts) -> RouterView:
    """Return the router and the account of the window, and what can be changed."""
    failed, account, off = world.router_trouble, world.account, "connect.checking" if world.choosing else ""
    if off:
        text, good = texts("connect.checking"), None
    elif failed is not None:
        text, good = texts(failed.key, **failed.slots), False
    else:
        text, good = _router_state(world, texts)
    own = texts("connect.no_account") if account is None else texts("connect.account", **_slots(account))
    return RouterView(
        world.endpoint,
        text,
        "" if failed is None or off else failed.detail,
        good,
        button(texts, "connect.use", actions.UseRouter(""), off),
        own,
        button(texts, "connect.join", actions.UseAccount(Path()), off),
    )


def _router_state(world: World, texts: Texts) -> tuple[str, bool | None]:
    """Return whether the present router answers and accepts the window, as a sentence and as a value."""
    match world.phase:
        case LinkPhase.ONLINE:
            return texts("connect.answers", robots=float(len(world.names))), True
        case LinkPhase.CONNECTING:
            return texts("banner.connecting", endpoint=world.endpoint), None
        case LinkPhase.NO_ROUTER:
            return texts("connect.unanswered", endpoint=world.endpoint), False
    return refused(world, texts), False


def refused(world: World, texts: Texts) -> str:
    """Return why the router does not accept this window, and what to do."""
    key, slots = refusal(world.endpoint, world.account, world.today)
    return texts(key, **slots)


def refusal(endpoint: str, account: Account | None, today: dt.date) -> tuple[str, dict[str, str]]:
    """Return the key and the slots of the text why the router at an endpoint does not accept an account, or none."""
    slots = {"endpoint": endpoint}
    if account is None:
        return "connect.needs_account", slots
    slots |= _slots(account)
    if today <= account.expires:
        return "connect.foreign", slots
    return "class.expired" if account.name == TEACHER else "connect.expired", slots


def _slots(account: Account) -> dict[str, str]:
    return {"account": account.name, "class": account.class_name, "expires": str(account.expires)}


def completed(address: str) -> str:
    """Return a typed address as endpoints: `192.168.1.20` becomes `tcp/192.168.1.20:7447`."""
    return ",".join(_endpoint(one.strip()) for one in address.split(","))


def _endpoint(address: str) -> str:
    if not address or "/" in address:
        return address
    with_port = address.rpartition(":")[2].isdigit() and (address.count(":") == 1 or "]:" in address)
    return f"tcp/{address}" if with_port else f"tcp/{address}:{PORT}"


def _port(port: UsbPort, texts: Texts, off: str) -> ButtonView:
    key = "connect.board" if port.board else "connect.port"
    return button(texts, key, ConnectHardware(port.device), off, device=port.device, title=port.title)


def simulate(_memory: Memory, world: World, intent: StartSimulation) -> list[Action]:
    """Return the action that starts a simulation, unless one starts."""
    return [] if world.starting else [intent]


def look_for_ports(memory: Memory, world: World, intent: LookForPorts) -> list[Action]:
    """Show the sheet; return the action that lists the ports, unless hardware is online."""
    memory.connecting, memory.port_chosen = True, False
    return [] if _serves(world) else [intent]


def use_port(memory: Memory, world: World, intent: ConnectHardware) -> list[Action]:
    """Return the action that starts the hardware, unless it starts."""
    memory.port_chosen = True
    return [] if world.connecting else [intent]


def close(memory: Memory, _world: World, _intent: CloseConnect) -> list[Action]:
    """Hide the sheet."""
    memory.connecting = False
    return []


def follow(memory: Memory, world: World) -> None:
    """Hide the sheet when the chosen hardware is online; forget leases and angles of a router that was left."""
    if memory.port_chosen and not world.connecting and _serves(world):
        memory.connecting = memory.port_chosen = False
    place = (world.endpoint, world.seat)
    if memory.router not in (("", ""), place):
        memory.standings, memory.lease_notice, memory.refusal = {}, None, None
        memory.forget_arms()
    memory.router = place


def _serves(world: World) -> bool:
    """Return whether hardware is online, and its board answers."""
    status = world.hw.status
    return online(world, "hw") and status is not None and fault_of(status) is not Fault.BOARD_LOST


HANDLES: Handles = {
    StartSimulation: simulate,
    LookForPorts: look_for_ports,
    ConnectHardware: use_port,
    CloseConnect: close,
}
