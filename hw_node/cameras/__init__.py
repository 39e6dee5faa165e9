"""The cameras of a robot: USB cameras, files and test pictures."""

from __future__ import annotations

from hw_node.cameras.camera import PATTERN as PATTERN
from hw_node.cameras.camera import Camera as Camera
from hw_node.cameras.camera import CameraChoice as CameraChoice
from hw_node.cameras.camera import choices as choices
from hw_node.cameras.camera import same_for_both as same_for_both
