"""Talks to router and robots on threads of its own; Qt's thread never waits for it.

`link` joins the parts: `connection` finds router and robots; a `request_queue` for each robot sends the requests to
that robot alone, `plans` the motions of both, `playing` choreographies, and `stopping` STOP on a thread of its own;
`cameras` and `probe` read; `recordings` and `children` start other programs.
"""

from __future__ import annotations

from gui.link.link import Link as Link
