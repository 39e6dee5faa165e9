"""What makes robots come online: router, simulation, and hardware at a port that the user chooses from a list."""

from __future__ import annotations

from beatrix_zenoh.contract._generated.messages import Fault
from gui.console.state.actions import Action, Connect, FindPorts, RunHardware, RunSimulation
from gui.console.state.intents import Intent, Retry, StartSimulation
from gui.console.state.memory import Memory
from gui.console.state.presence import online
from gui.console.state.views import ButtonView, ConnectView
from gui.console.state.world import UsbPort, World
from gui.console.texts import Texts

VIRTUAL = "virtual:"
"""Port of the virtual robot."""


class ConnectIntent(Intent, frozen=True):
    """Base class of the intents of the list."""


class LookForPorts(ConnectIntent, frozen=True):
    """Show the list, and look for the serial ports of this computer."""


class ConnectHardware(ConnectIntent, frozen=True):
    """Start the program of the hardware with a port."""

    port: str


class CloseConnect(ConnectIntent, frozen=True):
    """Hide the list."""


def view(memory: Memory, world: World) -> ConnectView | None:
    """Return the list; None while it is hidden."""
    if not memory.connecting:
        return None
    texts, failed = memory.choices.texts, world.child_trouble
    if world.connecting:
        text = texts("connect.starting")
    elif failed is not None:
        text = texts(failed.key, code=failed.code)
    elif world.ports is None:
        text = texts("connect.looking")
    else:
        text = texts("connect.choose" if any(port.board for port in world.ports) else "connect.no_board")
    off = world.connecting
    ports = tuple(_port(port, texts, off=off) for port in world.ports or ())
    virtual = ButtonView(
        texts("connect.virtual"), texts("connect.virtual_tip"), ConnectHardware(VIRTUAL), enabled=not off
    )
    return ConnectView(
        text,
        "" if failed is None or off else failed.detail,
        (*ports, virtual),
        ButtonView(texts("connect.again"), texts("connect.again_tip"), LookForPorts(), enabled=not off),
        ButtonView(texts("connect.close"), texts("connect.close_tip"), CloseConnect()),
    )


def _port(port: UsbPort, texts: Texts, *, off: bool) -> ButtonView:
    tooltip = texts("connect.board_tip" if port.board else "connect.port_tip", device=port.device)
    name = texts("connect.board" if port.board else "connect.port", device=port.device, title=port.title)
    return ButtonView(name, tooltip, ConnectHardware(port.device), enabled=not off)


def handle(memory: Memory, world: World, intent: Intent) -> list[Action]:
    """Return the action of an intent."""
    match intent:
        case StartSimulation():
            return [] if world.starting else [RunSimulation()]
        case Retry():
            return [Connect()]
        case LookForPorts():
            memory.connecting = True
            return [FindPorts()]
        case ConnectHardware(port=port):
            return [] if world.connecting else [RunHardware(port)]
    memory.connecting = False
    return []


def follow(memory: Memory, world: World) -> None:
    """Hide the list when hardware is online and its board answers."""
    status = world.hw.status
    if memory.connecting and not world.connecting and online(world, "hw") and status is not None:
        memory.connecting = status.fault is Fault.BOARD_LOST or not status.board.connected
