"""The connection to router and robots, on its own threads; Qt's thread waits for them only when the window closes.

`link` joins the parts. `jobs` runs what may wait, in queues. `connection` finds router and robots, and queries each robot. `moving` joins what
moves robots: a `RequestQueue` for each robot sends the requests to that robot alone, `plans` sends the motions of both,
and of `programs` the newest runs: it plays choreographies or follows a face. `governing` sends the
teacher's lease queries, `stopping` STOP. `pictures` reads; `children` starts other programs.
"""

from __future__ import annotations

from gui.console.link.link import Link as Link
