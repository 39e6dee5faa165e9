"""Access to Zenoh; no other package imports the library `zenoh`."""

from __future__ import annotations

from beatrix_zenoh.bus.declarations import CLOSED as CLOSED
from beatrix_zenoh.bus.declarations import Publication as Publication
from beatrix_zenoh.bus.endpoint import endpoints as endpoints
from beatrix_zenoh.bus.endpoint import is_listening as is_listening
from beatrix_zenoh.bus.endpoint import is_local as is_local
from beatrix_zenoh.bus.endpoint import parse_endpoint as parse_endpoint
from beatrix_zenoh.bus.endpoint import probe as probe
from beatrix_zenoh.bus.forks import ProcessBound as ProcessBound
from beatrix_zenoh.bus.incoming import Incoming as Incoming
from beatrix_zenoh.bus.incoming import Received as Received
from beatrix_zenoh.bus.messages import PUBLISHER as PUBLISHER
from beatrix_zenoh.bus.messages import QUERYABLE as QUERYABLE
from beatrix_zenoh.bus.messages import SUBSCRIBER as SUBSCRIBER
from beatrix_zenoh.bus.query import Query as Query
from beatrix_zenoh.bus.query import Reply as Reply
from beatrix_zenoh.bus.query import intersects as intersects
from beatrix_zenoh.bus.router import answer_checks as answer_checks
from beatrix_zenoh.bus.router import close_connections as close_connections
from beatrix_zenoh.bus.router import close_router as close_router
from beatrix_zenoh.bus.router import open_router as open_router
from beatrix_zenoh.bus.router import watch_router as watch_router
from beatrix_zenoh.bus.session import Bus as Bus
from beatrix_zenoh.bus.session import connect as connect
from beatrix_zenoh.bus.session import hanging_router as hanging_router
from beatrix_zenoh.bus.sessions import Sessions as Sessions
from beatrix_zenoh.bus.sessions import describe as describe
