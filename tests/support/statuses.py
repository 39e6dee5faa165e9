"""The status of a robot at rest that may move."""

from __future__ import annotations

from beatrix_zenoh.contract._generated.messages import BoardStatus, Fault, Status

BOARD = BoardStatus(
    connected=True, port="", name="bea", firmware="", contract="", boot=1, rejected_frames=0, retries=0
)
READY = Status(
    t_mono_ns=0,
    t_wall_ns=0,
    robot="bea",
    side="hw",
    enabled=True,
    calibrated=True,
    moving=False,
    motion=0,
    fault=Fault.NONE,
    warnings=[],
    calibrations=1,
    holder="",
    board=BOARD,
)
