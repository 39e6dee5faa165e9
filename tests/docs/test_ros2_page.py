"""The program of the page about ROS 2 publishes what rmw_zenoh reads: key, tokens, attachment and CDR."""

from __future__ import annotations

import queue
import re
import struct
from pathlib import Path

import numpy as np
import pytest
import zenoh
from robots import Stage

from beatrix_zenoh import Robot
from sim_node.model import build_spec

PAGE = Path(__file__).resolve().parents[2] / "docs/how-to/ros2.md"
HASH = "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"
WAIT_S = 20.0


def decoded(payload: bytes) -> tuple[int, list[str], list[float]]:
    """Return time (ns), names and positions of a JointState; offsets count from the end of its first four bytes."""
    assert payload[:4] == bytes((0, 1, 0, 0))
    data, at = payload[4:], 0

    def number(form: str) -> float:
        nonlocal at
        size = struct.calcsize(form)
        at = -(-at // size) * size + size
        value: float = struct.unpack(f"<{form}", data[at - size : at])[0]
        return value

    def text() -> str:
        nonlocal at
        length = int(number("I"))
        at += length
        assert data[at - 1] == 0
        return data[at - length : at - 1].decode()

    stamp_ns = int(number("i")) * 10**9 + int(number("I"))
    assert text() == ""
    names = [text() for _ in range(int(number("I")))]
    values = [number("d") for _ in range(int(number("I")))]
    assert (number("I"), number("I"), at) == (0, 0, len(data))
    return stamp_ns, names, values


@pytest.mark.long("moves a robot in real time")
def test_the_program_publishes_joint_states_for_rmw_zenoh(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = PAGE.read_text(encoding="utf-8")
    (program,) = re.findall(r"```python\n(# joint_states.py\n.*?)```", text, re.DOTALL)
    path = tmp_path / "joint_states.py"
    path.write_text(program, encoding="utf-8")
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    with Stage() as stage:
        stage.simulation("bea1", "--ready")
        monkeypatch.setenv("BEATRIX_CONNECT", stage.endpoint)
        config = zenoh.Config()
        config.insert_json5("mode", '"client"')
        config.insert_json5("connect/endpoints", f'["{stage.endpoint}"]')
        with zenoh.open(config) as session, Robot("bea1", "sim") as robot:
            robot.look(yaw=20, pitch=-10)
            heard: queue.Queue[zenoh.Sample] = queue.Queue()
            _all = session.declare_subscriber("0/**", heard.put)
            stage.script(path, "bea1", "sim")
            first, second = heard.get(timeout=WAIT_S), heard.get(timeout=WAIT_S)
            key = f"0/bea1/sim/joint_states/sensor_msgs::msg::dds_::JointState_/{HASH}"
            assert str(first.key_expr) == key
            assert first.attachment is not None
            assert second.attachment is not None
            number, sent_ns, length, gid = struct.unpack("<qqB16s", first.attachment.to_bytes())
            assert (number, length) == (0, 16)
            assert struct.unpack("<qqB16s", second.attachment.to_bytes())[::3] == (1, gid)
            stamp_ns, names, values = decoded(first.payload.to_bytes())
            assert stamp_ns == sent_ns
            hinges = [joint.name for joint in build_spec().joints if joint.name != "head"]
            assert names == [*sorted(hinges, key=lambda name: name[:3]), "yaw", "pitch", "roll"]
            at = robot.positions()
            np.testing.assert_allclose(np.degrees(values[:3]), at.arms, atol=0.5)
            np.testing.assert_allclose(np.degrees(values[6:]), at.head, atol=0.5)
            replies = session.liveliness().get("@ros2_lv/0/**")
            tokens = sorted(str(reply.ok.key_expr).split("/", 4)[4] for reply in replies if reply.ok)
            assert tokens == [
                "0/NN/%/%/beatrix_bea1_sim",
                f"1/MP/%/%/beatrix_bea1_sim/%bea1%sim%joint_states/{key.split('/', 4)[4]}/::,10:,:,:,,",
            ]
