"""The node, which serves one robot to the clients of a router."""

from __future__ import annotations

from beatrix_zenoh.node.camera import CameraPublisher as CameraPublisher
from beatrix_zenoh.node.camera import Frame as Frame
from beatrix_zenoh.node.component import Component as Component
from beatrix_zenoh.node.component import StatusFields as StatusFields
from beatrix_zenoh.node.context import Body as Body
from beatrix_zenoh.node.context import Context as Context
from beatrix_zenoh.node.hardware import Pose as Pose
from beatrix_zenoh.node.hardware import Preview as Preview
from beatrix_zenoh.node.node import Node as Node
from beatrix_zenoh.node.preview import PreviewHandler as PreviewHandler
