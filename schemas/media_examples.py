"""Examples of messages about pictures and sound, for the golden bytes."""

from __future__ import annotations

MEDIA: list[tuple[str, dict[str, object]]] = [
    (
        "SoundQuery",
        {"play": "noise", "seconds": 2.5, "x": 1.0, "y": -0.5, "z": 0.125, "mouth": False},
    ),
    ("SoundQuery", {"play": "", "seconds": 0.0, "x": None, "y": None, "z": None, "mouth": True}),
    (
        "SoundReply",
        {
            "result": True,
            "reason": "OK",
            "message": "",
            "play": "noise",
            "seconds": 2.5,
            "x": 1.0,
            "y": -0.5,
            "z": 0.125,
            "mouth": False,
        },
    ),
    (
        "FrameHeader",
        {
            "seq": 70000,
            "t_mono_ns": 123456789012345,
            "t_wall_ns": 1700000000123456789,
            "width": 640,
            "height": 480,
            "source": "pattern",
        },
    ),
    (
        "SoundHeader",
        {
            "seq": 70000,
            "t_mono_ns": 123456789012345,
            "t_wall_ns": 1700000000123456789,
            "rate": 48000,
            "dropped": 960,
            "source": "device",
        },
    ),
    (
        "MicrophonesStatus",
        {
            "connected": True,
            "streaming": True,
            "rate": 48000,
            "source": "tone",
            "dropped": 0,
            "trouble": "",
        },
    ),
    (
        "CameraStatus",
        {
            "eye": "left",
            "connected": True,
            "streaming": True,
            "hz": 29.5,
            "width": 640,
            "height": 480,
            "source": "v4l2",
            "trouble": "",
        },
    ),
]
