"""A real conductor, in the thread of a test."""

import threading
from collections.abc import Callable

from sqlalchemy.orm import Session

from wildscav_leaderboard.conductor.conductor import Conductor
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.folder import Season

LONGEST = 300.0  # s, on a busy machine


def conduct(database: Database, season: Season, until: Callable[[Session], bool]) -> None:
    """Run a conductor in this thread until something is true."""
    ended = threading.Event()
    conductor = Conductor(season, database)

    def watch() -> None:
        try:
            for _ in range(int(LONGEST / 0.2)):
                with database.reading() as session:
                    if until(session) or ended.wait(0.2):
                        break
        finally:  # also if the test fails there
            conductor.stop()

    watcher = threading.Thread(target=watch)
    watcher.start()
    conductor.run()
    ended.set()
    watcher.join()
