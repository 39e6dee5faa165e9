"""Keeps simulated time in step with wall time by absolute deadlines: late steps are still made, stalls are skipped."""

from __future__ import annotations

from collections import deque

PERIOD_S = 0.006
"""Period (s) of the simulation's thread, which makes the steps that are due."""
RESTING_S = 0.020
"""Period (s) while the arms rest and no frame for the board has arrived."""
LATE_S = 0.010
SLICE_S = 0.1
"""Longest simulated time of one call of `due`, so that the board receives its heartbeat between two calls."""
PAUSE_S = 0.001
"""Shortest time for other threads between two turns."""
STALL_S = 0.3
"""After a longer delay simulated time continues from now: the robot does not speed up, and misses no heartbeat."""
WINDOW_S = 5.0


class StepClock:
    """Computes how many steps are due; all times in seconds of one monotonic clock."""

    def __init__(self, step_s: float, now_s: float) -> None:
        self._step_s = step_s
        self._due_s = now_s
        self._simulated_s = 0.0
        self._period_s, self._turned_s = PERIOD_S, now_s
        self._marks: deque[tuple[float, float]] = deque([(now_s, 0.0)])
        self.late = 0
        """Steps made more than LATE_S late."""

    def due(self, now_s: float, *, host_is_late: bool = False) -> int:
        """Return the number of steps to make now; 0 after a stall or while the board waits for a late host."""
        behind_s = now_s - self._due_s
        if behind_s > STALL_S or host_is_late:
            self._due_s = now_s
            return 0
        steps = max(0, int(min(behind_s, SLICE_S) / self._step_s + 1e-6))
        if behind_s > LATE_S + self._period_s:
            self.late += min(steps, int((behind_s - LATE_S) / self._step_s))
        self._turned_s = now_s
        self._due_s += steps * self._step_s
        self._simulated_s += steps * self._step_s
        if now_s - self._marks[-1][0] > WINDOW_S / 10:
            self._marks.append((now_s, self._simulated_s))
            while now_s - self._marks[0][0] > WINDOW_S:
                self._marks.popleft()
        return steps

    @property
    def reached_s(self) -> float:
        """The time up to which steps have been made."""
        return self._due_s

    def wait_s(self, now_s: float, *, resting: bool) -> float:
        """Return the seconds until steps are due, at least PAUSE_S."""
        self._period_s = RESTING_S if resting else PERIOD_S
        return max(PAUSE_S, self._due_s + self._period_s - now_s)

    def real_time_factor(self, now_s: float) -> float:
        """Return the simulated seconds per second over the last WINDOW_S."""
        then_s, simulated_s = self._marks[0]
        # The period ends with the last turn of the thread, because the next turn makes the steps since then. If the
        # next turn is overdue, the period ends now, because the time since the last turn is lost.
        overdue = now_s - self._turned_s > STALL_S
        elapsed_s = (now_s if overdue else self._turned_s) - then_s
        return 1.0 if elapsed_s < PERIOD_S else (self._simulated_s - simulated_s) / elapsed_s
