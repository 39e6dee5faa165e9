"""Calls of the firmware's WebAssembly functions."""

from __future__ import annotations

import atexit
import ctypes
from collections.abc import Callable
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING

from beatrix_zenoh import hiding
from beatrix_zenoh.contract._generated.messages import Reason
from beatrix_zenoh.contract.errors import BeatrixError

if TYPE_CHECKING:
    from wasmtime import Engine, Func, Module, Store


@cache
def compiled() -> tuple[Engine, Module]:
    """Return the firmware, compiled once per process: modules are immutable and shared between instances."""
    try:
        import wasmtime  # noqa: PLC0415 - an optional dependency, of virtual boards only
    except ImportError as error:
        raise BeatrixError(
            Reason.BOARD_LOST,
            hiding.cause(error)
            or "A virtual board needs wasmtime, which is not installed. "
            "Run `beatrix install sim`, then try again.",
        ) from error
    engine = wasmtime.Engine()
    code = (resources.files("beatrix_zenoh.board") / "firmware.wasm").read_bytes()
    return engine, wasmtime.Module(engine, code)


atexit.register(compiled.cache_clear)  # free them: wasmtime cannot free objects that outlive its module


def direct(store: Store, function: Func) -> Callable[..., int]:
    """Return a quick call of a function with at most one argument, all values i32; not thread-safe.

    wasmtime's own call reads the type of the function and converts all values anew each time, which takes ten times as
    long as the firmware. This call uses the same C function without the conversions. Its Python objects are private:
    if another version of wasmtime has other ones, return its own call.
    """
    try:
        from wasmtime import _ffi as ffi  # noqa: PLC0415 - an optional dependency, of virtual boards only

        context, pointer = store._context(), function._func  # noqa: SLF001 - see above
        value = ffi.wasmtime_val_raw_t()
        trap = ctypes.POINTER(ffi.wasm_trap_t)()
        addresses = [
            ctypes.c_void_p(ctypes.addressof(one)) for one in (context.contents, pointer, value, trap)
        ]
        call = ctypes.CFUNCTYPE(ctypes.c_void_p, *[ctypes.c_void_p] * 3, ctypes.c_size_t, ctypes.c_void_p)(
            ("wasmtime_func_call_unchecked", ffi.dll)
        )
    except (ImportError, AttributeError, TypeError, ValueError):
        return lambda *arguments: function(store, *arguments)
    number = ctypes.c_int32.from_buffer(value)
    where, what, slot, trapped = addresses

    def run(argument: int = 0) -> int:
        number.value = argument
        if call(where, what, slot, 1, trapped) or trap:
            raise RuntimeError("The firmware of a virtual board has trapped. Restart this program.")
        return number.value

    run.kept = store, function, value, trap  # type: ignore[attr-defined] # while the addresses are used
    return run
