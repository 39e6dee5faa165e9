"""Memory of processes that run for hours."""

from __future__ import annotations

import gc
import subprocess
import sys

import pytest

from beatrix_zenoh import memory

THREADS = """
import ctypes, threading
from beatrix_zenoh import memory
if {shares}:
    memory.share_pools()
libc = ctypes.CDLL(None)
together = threading.Barrier(6)
def allocate():
    together.wait()
    libc.malloc(5000)
    together.wait()
threads = [threading.Thread(target=allocate) for _ in range(6)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
libc.malloc_info.argtypes = ctypes.c_int, ctypes.c_void_p
libc.malloc_info(0, ctypes.c_void_p.in_dll(libc, "stdout"))
libc.fflush(None)
"""
"""Program that allocates in six threads at the same time, and prints glibc's description of its pools."""


@pytest.mark.skipif(sys.platform != "linux", reason="glibc")
@pytest.mark.parametrize(("shares", "setting"), [(True, {}), (True, {"MALLOC_ARENA_MAX": "4"}), (False, {})])
def test_threads_share_two_pools_unless_the_user_has_chosen(
    shares: bool, setting: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("MALLOC_ARENA_MAX", raising=False)
    for name, value in setting.items():
        monkeypatch.setenv(name, value)
    code = THREADS.format(shares=shares)
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    pools = done.stdout.count("<heap nr=")
    assert pools == 2 if shares and not setting else pools > 2


def test_what_is_loaded_is_not_collected_again_and_what_comes_later_is() -> None:
    before = gc.get_threshold()
    memory.keep_loaded()
    try:
        assert gc.get_freeze_count() > 10_000
        later: list[object] = []
        later.append(later)
        del later
        assert gc.collect() > 0
    finally:
        gc.unfreeze()
        gc.set_threshold(*before)
