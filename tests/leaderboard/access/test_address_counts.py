"""How many requests an address may send, and how long it waits after too many."""

from wildscav_leaderboard.access.rate_limits import AddressCounts

FIRST = "192.0.2.1"


def used(counts: AddressCounts, moment: float, times: int) -> int:
    """Count requests at one moment; return how long the last one has to wait."""
    return [counts.use(FIRST, moment) for _ in range(times)][-1]


def test_requests_of_the_minute_before_count_in_part() -> None:
    counts = AddressCounts(10)
    assert used(counts, 600.0, 10) == 0
    assert used(counts, 660.0, 1) > 0  # all ten count
    assert used(counts, 690.0, 5) == 0  # five of them do
    assert used(counts, 690.0, 1) > 0


def test_whoever_waits_as_long_as_told_is_let_in() -> None:
    counts = AddressCounts(7)
    for start in (600.0, 613.0, 659.5):
        moment = start + 300.0
        assert used(counts, moment, 7) == 0
        wait = used(counts, moment, 1)
        assert counts.use(FIRST, moment + wait) == 0


def test_addresses_are_counted_apart_and_forgotten_after_two_minutes() -> None:
    counts = AddressCounts(1)
    assert counts.use(FIRST, 600.0) == 0
    assert counts.use("192.0.2.2", 600.0) == 0
    assert counts.use(FIRST, 600.0) > 0
    assert counts.use(FIRST, 720.0) == 0
