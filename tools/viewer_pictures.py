"""Pictures of a recording's tabs, drawn by a viewer without a window."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from rerun.experimental import ViewerClient

from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import Refused
from beatrix_zenoh.processes import free_port
from beatrix_zenoh.recording.rrd.scene import TABS
from beatrix_zenoh.recording.viewer import Viewer, address

SIZE: Final = "1456x819"
SETTLE_S: Final = 2.5
"""Pause before each picture: data arrive in a view some time after it is first shown, and no event reports when."""
NOTICE_S: Final = 5.0
"""Time for which the viewer covers the picture with a notice after its start."""
FILES: Final = tuple(title.lower().replace(" ", "-") for title in TABS)
"""Names of the tabs in names of files."""


def pictures(path: Path, shots: Sequence[tuple[int, float]]) -> list[bytes]:
    """Return PNG pictures of a recording, one for each of `shots`: a tab (0 to 3) and a moment (s since 1970).

    Raises:
        Refused, NoAnswer: the viewer cannot be started here, or cannot draw.
        ConnectionError: the viewer does not answer.
    """
    with Viewer(free_port(), "--headless", "--window-size", SIZE, "--hide-welcome-screen") as viewer:
        viewer.wait_ready()
        try:
            return _pictures(viewer, path, shots)
        except ConnectionError:
            time.sleep(NOTICE_S)  # it may just have stopped answering
            if viewer.code is not None:
                raise Refused(Reason.BAD_VALUE, viewer.ending()) from None
            raise


def _pictures(viewer: Viewer, path: Path, shots: Sequence[tuple[int, float]]) -> list[bytes]:
    """Return the pictures of `pictures` from a running viewer; raises ConnectionError if it ends meanwhile."""
    found = []
    client = ViewerClient.connect(address(viewer.port))
    shown_s = time.monotonic() + NOTICE_S
    (recording,) = client.open(str(path.absolute())).store_ids
    for tab, moment_s in shots:
        blueprint = client.get_blueprint(store_id=recording).blueprint
        bring_to_front(blueprint, tab)
        hide_menu(blueprint)
        client.set_blueprint(blueprint, store_id=recording)
        client.set_time("time", timestamp=moment_s, play_state="paused", recording=recording)
        time.sleep(max(SETTLE_S, shown_s - time.monotonic()))
        found.append(client.take_screenshot())
    return found


def bring_to_front(blueprint: dict[str, dict[str, dict[str, object]]], tab: int) -> None:
    """Change a blueprint so that its outermost tabs show this one."""
    containers = [
        entity["ContainerBlueprint"] for entity in blueprint.values() if "ContainerBlueprint" in entity
    ]
    inner = {str(part) for container in containers for part in parts_of(container)}
    for path, entity in blueprint.items():
        container = entity.get("ContainerBlueprint", {})
        if container.get("container_kind") == "Tabs" and path.strip("/") not in inner:
            container["active_tab"] = parts_of(container)[tab]


def hide_menu(blueprint: dict[str, dict[str, dict[str, object]]]) -> None:
    """Change a blueprint so that the menu, with its remarks about the computer, is not in the picture."""
    blueprint["/top_panel"] = {"PanelBlueprint": {"state": "Collapsed"}}


def parts_of(container: dict[str, object]) -> list[object]:
    """Return the parts of a container as a list; the viewer writes a single part without one."""
    contents = container.get("contents", [])
    return contents if isinstance(contents, list) else [contents]
