"""The node, which serves one robot to the clients of a router."""

from __future__ import annotations

from beatrix_zenoh.node.interfaces import ArmState as ArmState
from beatrix_zenoh.node.interfaces import Component as Component
from beatrix_zenoh.node.interfaces import StatusFields as StatusFields
from beatrix_zenoh.node.node import Node as Node
from beatrix_zenoh.node.sensors import SensorFrame as SensorFrame
from beatrix_zenoh.node.sensors import SensorKind as SensorKind
from beatrix_zenoh.node.sensors import SensorPublisher as SensorPublisher
from beatrix_zenoh.node.sensors import camera_publisher as camera_publisher
from beatrix_zenoh.node.sensors import microphones_publisher as microphones_publisher
from beatrix_zenoh.node.sensors import picture as picture
from beatrix_zenoh.node.sensors import sound_block as sound_block
from beatrix_zenoh.node.state import QueryThread as QueryThread
