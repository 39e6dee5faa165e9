"""The frame rate of the simulated cameras."""

from __future__ import annotations

from sim_node.eyes import SHARE, SLOWEST_S, FrameRate

REQUESTED_HZ = 15.0


class Drawer:
    """Draws when a picture is due, on its own clock; each picture takes `cost_s`."""

    def __init__(self, rate: FrameRate, cost_s: float) -> None:
        self.rate, self.cost_s, self.now_s = rate, cost_s, 100.0

    def draw(self, count: int, *, late: bool = False) -> float:
        """Draw `count` pictures; return their rate (Hz)."""
        begin_s = self.now_s
        for _ in range(count):
            self.now_s += self.rate.wait_s(self.now_s)
            drawn_s = self.now_s
            self.now_s += self.cost_s
            self.rate.drawn(drawn_s, self.cost_s, late=late)
        self.now_s += self.rate.wait_s(self.now_s)
        return count / (self.now_s - begin_s)


def test_a_slow_computer_draws_for_its_share_of_the_time() -> None:
    hz = Drawer(FrameRate(REQUESTED_HZ), 0.2).draw(100)
    assert abs(hz * 0.2 - SHARE) < 0.01


def test_late_physics_slows_drawing_to_the_lowest_rate() -> None:
    drawer = Drawer(FrameRate(REQUESTED_HZ), 0.02)
    drawer.draw(10)
    assert drawer.draw(3, late=True) < 0.8 * REQUESTED_HZ
    drawer.draw(50, late=True)
    assert drawer.rate.period_s == SLOWEST_S


def test_the_rate_recovers_when_physics_is_no_longer_late() -> None:
    drawer = Drawer(FrameRate(REQUESTED_HZ), 0.02)
    drawer.draw(50, late=True)
    drawer.draw(200)
    assert abs(drawer.draw(100) - REQUESTED_HZ) < 0.01
