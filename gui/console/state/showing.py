"""*Photo* and *Film*: what they show, and their last file."""

from __future__ import annotations

from gui.console.state.actions import Action, EndFilm, OpenPicture, TakePicture
from gui.console.state.memory import Handles, Memory
from gui.console.state.views import RecordView, ShowView, button
from gui.console.state.world import World, news, reading


def view(memory: Memory, world: World) -> ShowView:
    """Return the buttons; a picture shows the checked robots, or the only one whose pose is known."""
    texts, picture = memory.choices.texts, world.picture
    known = [side for side in ("sim", "hw") if reading(world, side) is not None]
    sides = tuple(side for side in known if side in memory.choices.sides) or tuple(known)
    titles = tuple(texts(f"side.{side}") for side in sides) if len(sides) > 1 else ("",)
    caption = f"{world.shown(world.seat)} · {world.robot}"
    photo, film = (TakePicture(film, sides, titles, caption) for film in (False, True))
    off = "picture.writing_tip" if picture.writing else "" if sides else "off.no_position"
    if picture.seconds is not None:
        clock = texts("minutes", minutes=picture.seconds // 60, seconds=picture.seconds // 1 % 60)
        toggle = button(texts, "picture.film_end", EndFilm())
        busy = button(texts, "picture.photo", photo, "picture.film_end_tip")
        return ShowView(busy, RecordView(toggle, running=True, text=clock, open=None))
    shown = None
    if picture.file is not None:
        shown = button(texts, "picture.open", OpenPicture(picture.file), file=str(picture.file))
    toggle = button(texts, "picture.writing" if picture.writing else "picture.film", film, off)
    return ShowView(
        button(texts, "picture.photo", photo, off), RecordView(toggle, running=False, text="", open=shown)
    )


def take(memory: Memory, world: World, action: TakePicture) -> list[Action]:
    """Return the action; its file will be the news of the last line."""
    memory.news = news(world)
    return [action]


HANDLES: Handles = {TakePicture: take}
