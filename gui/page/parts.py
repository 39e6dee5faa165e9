"""Parts of the view of a page: those of the window, without what pages may not use."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Final, get_args

import msgspec

from beatrix_zenoh.client.choreography import EMOTIONS
from beatrix_zenoh.client.own_gestures import possible
from beatrix_zenoh.contract._generated.messages import LeaseAction
from gui.console.state import missions
from gui.console.state.actions import AskLease, LookForPorts, StartSimulation
from gui.console.state.own_gestures import DeleteGesture
from gui.console.state.views import (
    BannerView,
    ButtonView,
    ClassView,
    GesturesView,
    PillView,
    View,
    button,
)
from gui.console.state.world import LinkPhase, World
from gui.console.texts import Texts, load
from gui.page.messages import DRIVING, OWN

OFFERED: Final = get_args(OWN) + get_args(DRIVING)
ENCODER: Final = msgspec.json.Encoder(enc_hook=str)  # `str`, because some buttons of the console name a file
TEXT_KEYS: Final = ("page.", "picture.", "label.", "arm.", "gesture.", "blocks.", "sequence.gesture")
"""Beginnings of the keys of the texts that the scripts of the page use."""


@cache
def texts_of_page(code: str) -> msgspec.Raw:
    """Return the texts that the scripts of the page use, in one language; encoded once, because views are frequent."""
    texts, _ = load(code)
    return msgspec.Raw(
        ENCODER.encode({name: text for name, text in texts.items() if name.startswith(TEXT_KEYS)})
    )


def guide(view: View, done: int, texts: Texts) -> dict[str, object] | None:
    """Return the present step or mission; after the last one (`done` of them are) the page leads to the lessons."""
    shown, over = view.guide, done >= len(missions.TASKS)
    if shown is None:
        closed = done >= missions.CLOSED
        return {"resume": button(texts, "page.missions", missions.ResumeGuide())} if closed else None
    buttons = {type(button.intent): button for button in shown.buttons}
    return {
        "text": texts("page.missions_done") if over else shown.text,
        "progress": "" if over else shown.progress,
        "count": shown.count,
        "good": over or shown.good is True,
        "hint": buttons.get(missions.ShowHint),
        "skip": buttons.get(missions.SkipTask),
        "close": replace(buttons[missions.CloseGuide], text="✕", tooltip=texts("page.missions_close")),
    }


def gestures(view: GesturesView, texts: Texts) -> dict[str, object]:
    """Return name, emoji and button of each gesture, own ones at the end, and of the shipped programs.

    Also return name and button of those that the page may delete.
    """
    shipped = [(name, EMOTIONS.get(name, ""), button) for name, button in view.gestures]
    own = [(own.name, own.emoji, own.play) for own in view.own if possible(own.name)]
    programs = [("follow", "☺", view.follow), ("turn", "♫", view.turn)]
    deletes = [
        (own.name, replace(button, question=texts("page.gesture_delete", name=own.name)))
        for own in view.own
        for button in own.menu
        if isinstance(button.intent, DeleteGesture)
    ]
    return {
        "gestures": shipped + own,
        "programs": programs,
        "deletes": deletes,
        "refusal": view.refusal,
    }


def governing(view: ClassView | None) -> dict[str, object] | None:
    """Return the buttons and sentences with which the teacher's page governs the class; None for other pages."""
    if view is None:
        return None
    return {
        "all": (view.freeze_all, view.unfreeze_all, view.limit),
        "rows": [(row.freeze, row.take, row.show) for row in view.rows],
        "seats": [(seat.text, seat.mute) for seat in view.seats],
        "texts": (view.summary, view.limit_now, view.result),
    }


def offered(button: ButtonView | None) -> ButtonView | None:
    """Return the button, if pages may use its intent."""
    return button if button is not None and isinstance(button.intent, OFFERED) else None


def pill(view: PillView) -> PillView:
    """Return the pill without a button that pages may not use, and without a reason that mentions it."""
    step = offered(view.next_step)
    reason = view.reason if step == view.next_step else ""
    # The button beside *Drive* gives both robots back.
    gives_back = view.lease is not None and view.lease.intent == AskLease(LeaseAction.GIVE_BACK, view.side)
    return replace(view, next_step=step, reason=reason, lease=None if gives_back else view.lease)


def banner(view: View, world: World) -> BannerView | None:
    """Return the banner without buttons that pages may not use; a text that mentions them is replaced."""
    shown, texts = view.banner, view.choices.texts
    if shown is None:
        return None
    buttons = tuple(button for button in shown.buttons if offered(button))
    if any(isinstance(button.intent, StartSimulation | LookForPorts) for button in shown.buttons):
        key = "page.no_robot" if world.phase is LinkPhase.ONLINE else "page.no_router"
        return BannerView(texts(key, robot=view.robot), buttons)
    return BannerView(shown.text, buttons)
