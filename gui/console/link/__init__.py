"""The connection to router and robots, on its own threads; Qt's thread waits for them only when the window closes.

`link` joins the parts. `jobs` runs what may wait, in queues. `connection` finds router and robots, and queries each
robot. `moving` keeps one list of requests: motions of one robot or both (`request`), held buttons (`jogging`), plays
(`choreographies`), and the program that follows a face (`programs`). `governing` sends the teacher's lease queries,
`stopping` STOP. `pictures` reads; `children` starts other programs.
"""

from __future__ import annotations

from gui.console.link.link import Link as Link
