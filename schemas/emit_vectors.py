"""Golden bytes: schemas/vectors/*.json, made from the examples here by the encoders of golden_bytes.py."""

from __future__ import annotations

import json
import struct

from contract import Contract, rows
from golden_bytes import cobs, crc16, msgpack, payload
from media_examples import MEDIA
from state_examples import STATES

POSE: dict[str, object] = {
    "absolute": True,
    "yaw": 0.5,
    "pitch": -0.125,
    "roll": 0.0,
    "lease": 0,
    "lead": 2.0,
    "source": "window",
}
DETAIL: dict[str, object] = {
    "limit": "TILT",
    "value": 0.75,
    "high": 0.5,
    "unit": "rad",
    "arms": [],
    "at_goal": True,
    "field": "",
    "known": [],
    "holder": "",
    "presser": "",
    "needs": ["ENABLE", "CALIBRATE"],
    "alternative": {
        "head": {"yaw": 0.0, "pitch": 0.5, "roll": 0.0},
    },
}
EVENT: dict[str, object] = {
    "seq": 3,
    "t_mono_ns": 123456789012345,
    "t_wall_ns": 1700000000123456789,
    "kind": "command",
    "action": "ENABLE",
    "seat": "ana",
    "session": "4711",
    "reason": "EMERGENCY",
    "message": "EMERGENCY_STOP is latched.",
    "motion": 0,
    "duration": 0.0,
    "count": 2,
    "source": "sdk",
}
MESSAGES: list[tuple[str, dict[str, object]]] = [
    ("Vector3", {"x": 0.1, "y": -0.25, "z": 1.5}),
    ("Steps", {"x": 0, "y": -129, "z": 70000}),
    ("Head", {"yaw": 0.5, "pitch": -0.125, "roll": 0.0}),
    (
        "MotionQuery",
        {
            "absolute": True,
            "position": {"x": 0.1, "y": -0.25, "z": 1.5},
            "speed": {"x": 0.5, "y": 0.5, "z": 0.5},
            "lease": 0,
            "source": "zenoh",
        },
    ),
    (
        "MotionQuery",
        {
            "absolute": False,
            "position": {"x": 0.0, "y": 0.0, "z": -0.0625},
            "lease": 7,
            "lead": 2.0,
            "source": "window",
        },
    ),
    ("PoseQuery", POSE),
    ("PoseQuery", POSE | {"absolute": False, "yaw": 0.0, "speed": 1.0, "lease": 70000, "lead": None}),
    ("LeaseQuery", {"action": "wait", "speed": 0.7, "longest_s": 90.0, "seat": ""}),
    ("LeaseQuery", {"action": "limit", "speed": 0.5, "longest_s": 0.0, "seat": ""}),
    ("LeaseQuery", {"action": "mute", "speed": 0.0, "longest_s": 0.0, "seat": "cem"}),
    (
        "LeaseReply",
        {
            "result": True,
            "reason": "OK",
            "message": "",
            "lease": 3,
            "holder": "ana",
            "waiting": ["ben"],
        },
    ),
    ("TargetQuery", {"x": 1.25, "y": -0.5, "z": 0.125, "path": "", "period_s": 12.0}),
    (
        "TargetReply",
        {
            "result": False,
            "reason": "BAD_VALUE",
            "message": "The room allows -2.0 to 2.0 m.",
            "x": 1.25,
            "y": 0.0,
            "z": 0.125,
        },
    ),
    ("CommandQuery", {"command": 1, "value": True, "source": "page"}),
    ("CommandQuery", {"command": -2, "value": False, "source": "zenoh"}),
    ("FollowQuery", {"follow": True, "source": "cli"}),
    (
        "CommandReply",
        {
            "result": False,
            "reason": "NOT_ENABLED",
            "message": "Die Motoren sind aus – ✓",
            "position": {"x": 0.0, "y": 0.0, "z": 0.0},
        },
    ),
    (
        "ErrorReply",
        {
            "result": False,
            "reason": "BAD_VALUE",
            "message": "This robot has no key.",
            "detail": DETAIL,
        },
    ),
    (
        "MotionReply",
        {
            "result": True,
            "phase": "accepted",
            "reason": "OK",
            "message": "",
            "motion": 65535,
            "duration": 1.25,
            "position": {"x": 0.5, "y": 0.5, "z": 0.5},
        },
    ),
    (
        "MotionReply",
        {
            "result": False,
            "phase": "accepted",
            "reason": "OUT_OF_REACH",
            "message": "The head would tilt 40.0°.",
            "motion": 0,
            "duration": 0.0,
            "position": {"x": 0.0, "y": 0.0, "z": 0.0},
            "detail": DETAIL,
        },
    ),
    ("Event", EVENT),
    (
        "Event",
        EVENT
        | {
            "kind": "motion",
            "action": "pose",
            "phase": "accepted",
            "reason": "OK",
            "message": "Accepted: 1.2 s.",
            "motion": 17,
            "source": "window",
            "pose_query": POSE,
            "position": {"x": 0.5, "y": 0.5, "z": 0.5},
        },
    ),
    ("NoteQuery", {"text": "trial 3 begins"}),
    (
        "NoteReply",
        {
            "result": True,
            "reason": "OK",
            "message": "",
            "file": "lesson.rrd",
            "title": "Lesson 2",
            "t_wall_ns": 1700000000123456789,
        },
    ),
    ("LessonState", {"version": 1, "tries": 7, "hints": 2, "figure": "nods", "stuck": 5, "passed": False}),
    ("Clock", {"t_mono_ns": 123456789012345, "t_wall_ns": 1700000000123456789}),
    (
        "ProgramInfo",
        {
            "program": "lesson.py",
            "side": "",
            "serves": [],
            "publishes": [],
            "subscribes": ["beatrix/bea/hw/state/positions"],
            "asks": ["beatrix/bea/hw/cmd/ana/pose", "beatrix/*/*/stop"],
        },
    ),
    *MEDIA,
    *STATES,
]

FRAMES: list[tuple[str, int, dict[str, object]]] = [
    ("HELLO", 1, {}),
    ("PING", 255, {}),
    ("MOVE", 7, {"motion": 513, "target": [100, -200, 32767], "speed": [1400, 1, 65535]}),
    ("MOVE", 0, {"motion": 0, "target": [0, 0, 0], "speed": [256, 256, 256]}),
    ("MOVE_STRAIGHT", 8, {"motion": 514, "target": [0, -32768, 7], "speed": 1400}),
    ("STOP", 3, {}),
    ("EMERGENCY_STOP", 4, {}),
    ("ENABLE", 5, {"value": 1}),
    ("CALIBRATE", 6, {}),
    ("SET_NAME", 9, {"name": "bea1"}),
    ("TEXT_OPEN", 10, {}),
    ("RESET", 11, {}),
]


def completed(contract: Contract, name: str, given: dict[str, object]) -> dict[str, object]:
    """Return an example with all fields of its message and of those in it; fields that are not given have their default."""
    found = {}
    for field, row in rows(contract.messages["message"][name]).items():
        value = given.get(field, row.get("default"))
        found[field] = completed(contract, str(row["type"]), value) if isinstance(value, dict) else value
    return found


def files(contract: Contract) -> dict[str, str]:
    """Return the text of every file of golden bytes by its relative path."""
    examples = [(name, completed(contract, name, given)) for name, given in MESSAGES]
    messages = [
        {"message": name, "value": value, "msgpack": msgpack(value).hex()} for name, value in examples
    ]
    frames = []
    for name, seq, values in FRAMES:
        body = bytes([int(str(contract.serial["frame"][name]["type"])), seq]) + payload(
            contract, name, values
        )
        wire = b"\0" + cobs(body + struct.pack("<H", crc16(body))) + b"\0"
        frames.append({"frame": name, "seq": seq, "fields": values, "wire": wire.hex()})
    return {
        "schemas/vectors/messages.json": json.dumps(messages, indent=1, ensure_ascii=False) + "\n",
        "schemas/vectors/serial.json": json.dumps(frames, indent=1) + "\n",
    }
