"""Zenoh, and nobody else imports it."""

from __future__ import annotations

from beatrix_zenoh.bus.endpoint import listens as listens
from beatrix_zenoh.bus.endpoint import ours as ours
from beatrix_zenoh.bus.endpoint import parts as parts
from beatrix_zenoh.bus.endpoint import probe as probe
from beatrix_zenoh.bus.question import Answer as Answer
from beatrix_zenoh.bus.question import Question as Question
from beatrix_zenoh.bus.router import open_router as open_router
from beatrix_zenoh.bus.session import Bus as Bus
from beatrix_zenoh.bus.session import Incoming as Incoming
from beatrix_zenoh.bus.session import Publication as Publication
from beatrix_zenoh.bus.session import connect as connect
