"""The tables of a language."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from beatrix_zenoh.contract._generated.messages import Limit, Reason

Key = tuple[Reason, Limit | None, str]
"""Reason, limit and case of a sentence; `(reason, None, "")` is the general sentence of a reason."""


class Language(NamedTuple):
    """Templates of one language; their fields are those of `slots.slots_of`."""

    decimal: str
    """decimal sign"""
    conjunction: str
    """word before the last entry of a list"""
    arms: Mapping[str, str]
    """names of the arms"""
    commands: Mapping[str, str]
    """verbs of the commands to send first"""
    refusals: Mapping[Key, str]
    """what happened, what is allowed and, if it is always the same, what to do"""
    leaves: str
    """when and where a motion leaves the limits"""
    head: str
    """a head orientation that would be accepted"""
    position: str
    """arm angles that would be accepted"""
    speed: str
    """speeds that would be accepted"""
    nothing: str
    """sentence if no alternative was found"""
