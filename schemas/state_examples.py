"""Examples of what a robot publishes all the time, for the golden bytes: positions, and the whole status."""

from __future__ import annotations

from media_examples import MEDIA

SENSORS = dict(MEDIA)
STATES: list[tuple[str, dict[str, object]]] = [
    (
        "Positions",
        {
            "seq": 4294967295,
            "t_mono_ns": 123456789012345,
            "t_wall_ns": 1700000000123456789,
            "position": {"x": 0.1, "y": -0.25, "z": 1.5},
            "velocity": {"x": 0.0, "y": 0.0, "z": -0.5},
            "commanded": {"x": 0.1, "y": -0.25, "z": 1.5},
            "steps": {"x": 73, "y": -183, "z": 1100},
            "head": {"yaw": 0.5, "pitch": -0.125, "roll": 0.0},
            "repeated": True,
        },
    ),
    (
        "Status",
        {
            "t_mono_ns": 123456789012345,
            "t_wall_ns": 1700000000123456789,
            "robot": "bea",
            "side": "sim",
            "enabled": True,
            "calibrated": False,
            "moving": False,
            "motion": 70,
            "fault": "ASSEMBLY_LEFT",
            "warnings": ["left eye: The camera is unplugged: plug it in."],
            "calibrations": 2,
            "holder": "ana",
            "lease": 3,
            "waiting": ["ben", "cem"],
            "turn_s": 90,
            "frozen": True,
            "speed_limit": 0.5,
            "muted": ["dora"],
            "teacher_latch": False,
            "stops": [{"seat": "", "count": 300}],
            "board": {
                "connected": True,
                "port": "virtual:",
                "name": "bea",
                "firmware": "1.2.3",
                "contract": "0badcafe",
                "boot": 3,
                "rejected_frames": 0,
                "retries": 129,
                "overflowed_bytes": 255,
            },
            "following": "off",
            "plant": {"real_time_factor": 0.5, "late_steps": 1, "slipped_steps": -2, "re_placed": 1},
            "cameras": [SENSORS["CameraStatus"]],
            "microphones": SENSORS["MicrophonesStatus"],
        },
    ),
]
