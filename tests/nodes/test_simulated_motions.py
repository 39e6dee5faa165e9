"""Firmware, limits and plant in virtual time: many motions with exact outcomes."""

from __future__ import annotations

import bench_poses
from bench_plant import closure_error

from beatrix_zenoh.board.link import encode
from beatrix_zenoh.contract._generated.serial import FrameType, Move


def test_jumps_without_the_checks_of_the_node_never_leave_the_home_assembly() -> None:
    """Commands sent directly to the firmware, at full speed, from one extreme to the other."""
    bench = bench_poses.Bench()
    for number, target in enumerate(
        [(1000, 0, 0), (-1000, 1000, 0), (2000, 2000, 2000), (0, -1000, 1000)] * 3
    ):
        move = Move(number + 1, target, (4000, 4000, 4000))
        bench.firmware.receive(encode(FrameType.MOVE, number + 1, move.pack()))
        for _ in range(4):  # the next jump begins during the motion
            bench.firmware.receive(encode(FrameType.PING, 200, b""))
            bench.run(100)
            assert not bench.plant.home_assembly_left()
            assert closure_error(bench.plant) < 1e-3
    assert bench.plant.re_placed == 0
