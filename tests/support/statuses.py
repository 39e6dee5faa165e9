"""Status and positions of a robot that rests at home and may move."""

from __future__ import annotations

from beatrix_zenoh.contract._generated.messages import (
    BoardStatus,
    Fault,
    Head,
    Positions,
    Status,
    Steps,
    Vector3,
)

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
ZERO = Vector3(0.0, 0.0, 0.0)
AT_HOME = Positions(
    seq=1, t_mono_ns=1, t_wall_ns=1, position=ZERO, velocity=ZERO, commanded=ZERO, steps=Steps(0, 0, 0),
    head=Head(0.0, 0.0, 0.0),
)  # fmt: skip
