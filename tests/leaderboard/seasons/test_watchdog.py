"""A thread whose work breaks goes on, and the metrics say how often that was."""

import threading

import pytest

from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons import watchdog
from wildscav_leaderboard.seasons.state import RESTARTS, read_state


def test_work_that_breaks_is_begun_again_and_counted(
    database: Database, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(watchdog, "PAUSE", 0.0)
    ended, begun = threading.Event(), []

    def work() -> None:
        begun.append(1)
        if len(begun) < 3:
            raise OverflowError("getsockaddrarg: port must be 0-65535")
        ended.set()

    thread = watchdog.watched_thread("webhooks", work, ended, database)
    thread.start()
    thread.join()

    assert len(begun) == 3
    with database.reading() as session:
        assert read_state(session, RESTARTS) == {"webhooks": 2}
