"""Memory of processes that run for hours: what the C library and Python keep."""

from __future__ import annotations

import ctypes
import gc
import os
import sys
from typing import Final

M_ARENA_MAX: Final = -8
"""Number of the option of `mallopt` for the largest number of pools."""
POOLS: Final = 2


def share_pools() -> None:
    """Let all threads share two pools of memory, unless MALLOC_ARENA_MAX is set; call it before threads start.

    By default glibc makes eight for each core, and each of Zenoh's threads keeps in its own what was freed there: robots
    grew with each restart of their router (decision 0151). Other allocators of Linux (musl) have no such functions.
    """
    if sys.platform == "linux" and "MALLOC_ARENA_MAX" not in os.environ:
        getattr(ctypes.CDLL(None), "mallopt", min)(M_ARENA_MAX, POOLS)


def give_back() -> None:
    """Return freed memory to the system, which the allocator of Linux keeps."""
    if sys.platform == "linux":
        getattr(ctypes.CDLL(None), "malloc_trim", int)(0)


def keep_loaded() -> None:
    """Exclude all present objects, which stay until the end, from garbage collection; call it when a program is ready.

    A collection of old objects, during which no thread runs, then takes no longer than one of new objects and may take
    place more often: what a closed page leaves is old, and Python would first look at it after 200 pages (decision 0151).
    """
    gc.freeze()
    gc.collect()  # counts the old objects anew
    gc.set_threshold(*gc.get_threshold()[:2], 1)
