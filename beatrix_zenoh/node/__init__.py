"""A robot on the bus."""

from __future__ import annotations

from beatrix_zenoh.node.body import Body as Body
from beatrix_zenoh.node.body import Pose as Pose
from beatrix_zenoh.node.body import Preview as Preview
from beatrix_zenoh.node.node import Node as Node
from beatrix_zenoh.node.roads import Roads as Roads
from beatrix_zenoh.node.terminal import Terminal as Terminal
