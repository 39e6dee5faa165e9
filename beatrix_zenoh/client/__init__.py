"""The SDK: access to robots for programs, command line, window and recorder."""

from __future__ import annotations

from beatrix_zenoh.client.degrees import suggestion as suggestion
from beatrix_zenoh.client.monitor import Monitor as Monitor
from beatrix_zenoh.client.monitor import Presence as Presence
from beatrix_zenoh.client.monitor import RobotState as RobotState
from beatrix_zenoh.client.motion import Motion as Motion
from beatrix_zenoh.client.robot import Robot as Robot
from beatrix_zenoh.client.session import Client as Client
from beatrix_zenoh.client.session import Place as Place
from beatrix_zenoh.client.subscription import CameraImage as CameraImage
from beatrix_zenoh.client.subscription import Subscription as Subscription
from beatrix_zenoh.client.twin import Plan as Plan
from beatrix_zenoh.client.twin import Twin as Twin
from beatrix_zenoh.contract.errors import BeatrixError as BeatrixError
from beatrix_zenoh.contract.errors import Interrupted as Interrupted
from beatrix_zenoh.contract.errors import NoAnswer as NoAnswer
from beatrix_zenoh.contract.errors import Refused as Refused
