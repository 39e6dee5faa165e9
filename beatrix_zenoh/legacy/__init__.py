"""The port of programs of 2023: the text protocol on a pseudo-terminal."""

from __future__ import annotations

from beatrix_zenoh.legacy.interface import NodeInterface as NodeInterface
from beatrix_zenoh.legacy.line import Effect as Effect
from beatrix_zenoh.legacy.line import LineCause as LineCause
from beatrix_zenoh.legacy.port import TextPort as TextPort
from beatrix_zenoh.legacy.terminal import Terminal as Terminal
