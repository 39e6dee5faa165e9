"""What all graphical faces share: decisions, links to the robots, and texts; without Qt and without a web server."""

from __future__ import annotations
