"""The connection to router and robots, on its own threads; Qt's thread waits for them only when the window closes.

`link` joins the parts. `connection` finds router and robots. `moving` joins what moves robots: a `request_queue` for
each robot sends the requests to that robot alone, `plans` sends the motions of both, `playing` plays choreographies,
`face_program` runs the program that follows a face. `governing` sends the teacher's lease queries, `stopping` STOP.
`cameras` and `probe` read; `recordings` and `children` start other programs.
"""

from __future__ import annotations

from gui.console.link.link import Link as Link
