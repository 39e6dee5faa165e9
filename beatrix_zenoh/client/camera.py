"""Pictures of a robot's eyes, and of a simulation from outside, as JPEG with the time of their exposure."""

from __future__ import annotations

from dataclasses import dataclass

from beatrix_zenoh.bus import Reply
from beatrix_zenoh.client.session import Client
from beatrix_zenoh.client.subscription import Sample, Subscription
from beatrix_zenoh.contract import codec, names
from beatrix_zenoh.contract._generated import keys
from beatrix_zenoh.contract._generated.messages import FrameHeader, Reason
from beatrix_zenoh.contract.errors import WrongUsage, quoted

START_S = 10.0
"""Time limit (s) for the first picture; some cameras take two seconds, a simulation on a busy computer longer."""
LENGTH = 4
"""Queue length: short, because a slow reader does not need old pictures."""
JPEG_BEGIN = b"\xff\xd8"
"""First bytes of every JPEG file."""


@dataclass(frozen=True)
class CameraImage:
    """A picture of one eye, or of a simulated head from outside."""

    jpeg: bytes
    """the contents of a JPEG file"""
    eye: str
    """`left`, `right` or `outside`"""
    seq: int
    """number of the picture, counted for each camera; a gap shows lost pictures"""
    t_mono_ns: int
    """monotonic clock of the robot at the exposure (ns)"""
    t_wall_ns: int
    """wall clock of the robot at the exposure, ns since 1970"""
    width: int
    """pixels"""
    height: int
    """pixels"""
    source: str
    """origin of the picture, for example `v4l2`, `pattern` or `egl`"""
    arrived_mono_ns: int
    """monotonic clock of this computer at the arrival (ns)"""
    arrived_wall_ns: int
    """wall clock of this computer at the arrival, ns since 1970"""

    def __str__(self) -> str:
        size = f"{self.width} x {self.height} px, {len(self.jpeg) / 1000:.1f} kB"
        return f"{names.view_title(self.eye)}, picture {self.seq}: {size}, {self.source}"


def images(
    client: Client,
    robot: str,
    side: str,
    eye: str,
    *,
    timeout_s: float | None,
    length: int = LENGTH,
) -> Subscription[CameraImage]:
    """Subscribe to pictures; `*` stands for all robots or both sides. See `Subscription` for `timeout_s` and `length`.

    Raises:
        WrongUsage: BAD_VALUE: there is no such eye, or hardware has no outside view; SHUTDOWN: the client was closed.
        NoAnswer: NO_ROUTER or ACCOUNT_REFUSED.
    """
    if eye not in names.VIEWS:
        choice = "choose 'left' or 'right', or 'outside' for a simulation as seen from outside"
        raise WrongUsage(Reason.BAD_VALUE, f"There is no eye {quoted(eye)}: {choice}.")
    if eye == names.OUTSIDE and side == "hw":
        text = "Only simulations draw an outside view: choose the side 'sim', or the eye 'left' or 'right'."
        raise WrongUsage(Reason.BAD_VALUE, text)
    key = keys.camera(robot, side, eye)
    return Subscription(client, key, image, timeout_s=timeout_s, length=length, bus=client.media)


def image(client: Client, sample: Sample) -> CameraImage | None:
    """Convert a publication to a picture; log a warning and return None if it is not a JPEG with a valid header."""
    received, parts = sample.received, keys.parse(sample.received.key)
    answer = Reply(
        received.key, received.attachment or b"", codec.MSGPACK, error=False, sender=received.session
    )
    if not received.payload.startswith(JPEG_BEGIN):
        client.report(
            answer, "ignored: it is not a JPEG picture. Another program publishes on this key: end it."
        )
        return None
    header = client.read(answer, FrameHeader)
    if parts is None or header is None:
        return None
    return CameraImage(
        jpeg=received.payload,
        eye=parts.eye,
        seq=header.seq,
        t_mono_ns=header.t_mono_ns,
        t_wall_ns=header.t_wall_ns,
        width=header.width,
        height=header.height,
        source=header.source,
        arrived_mono_ns=sample.t_mono_ns,
        arrived_wall_ns=sample.t_wall_ns,
    )
