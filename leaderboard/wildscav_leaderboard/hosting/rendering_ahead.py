"""Maps, trails and posters of matches, made when matches begin and end, so that nobody who comes has to wait.

The web server looks for what is new, since it renders and keeps such files anyway, and the conductor has
matches to play. It begins one file after the other, those of the newest matches first: where matches end
faster than they are rendered, older ones are left to whoever asks for them.
"""

import threading
from collections import deque
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Self

from sqlalchemy.orm import Session

from wildscav_engine.specs.map_spec import MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_leaderboard.database.connection import Database, DatabaseError
from wildscav_leaderboard.matches.models import PLAYING, WAITING, Match
from wildscav_leaderboard.matches.service import list_matches
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import NotFoundError
from wildscav_leaderboard.seasons.watchdog import watched_thread
from wildscav_leaderboard.spectating.render_cache import RenderCache
from wildscav_leaderboard.visibility import FROZEN, path_of_record, perhaps_shown, seen_by, twins_of
from wildscav_server.monitoring.logs import Log

EVERY = 2.0  # s between two looks
REMEMBERED = 500  # files that are not begun again, even if the cache is too small to keep them
Order = tuple[str, int, Match]  # product, number of the match that it is for, and match to make it from
LIVE, OVER = "map", ("trails", "poster")  # products; the map comes with the trails


class RenderingAhead:
    """Has rendered what people will ask for, until it exits. It is a context manager.

    Args:
        log: Where to report that it broke and goes on.
    """

    def __init__(
        self, season: Season, database: Database, renders: RenderCache, log: Log | None = None
    ) -> None:
        self._season, self._database, self._renders = season, database, renders
        self._done = deque[tuple[str, int]](maxlen=REMEMBERED)
        self._last: tuple[str, str] | None = None  # that was begun: product and key
        self._ended = threading.Event()
        self._thread = watched_thread("rendering", self._look, self._ended, database, log)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()

    def _look(self) -> None:
        while not self._ended.wait(EVERY):
            with suppress(DatabaseError), self._database.reading() as session:
                self.begin_next(session)

    def begin_next(self, session: Session) -> None:
        """Begin to render the next file, unless the last one is still being rendered."""
        if self._last is not None and self._renders.is_rendering(*self._last):
            return
        live, over = _wanted(session)
        # In turn, so that neither waits for ever where matches begin and end faster than they are drawn.
        for product, number, match in over + live if self._last and self._last[0] == LIVE else live + over:
            if (product, number) in self._done or self._renders.is_kept(product, str(number)):
                continue
            self._done.append((product, number))
            with suppress(NotFoundError):  # the record is gone
                self._last, source = (product, str(number)), self._source(session, match)
                self._renders.progress(*self._last, source, datetime.now(UTC))
                return

    def _source(self, session: Session, match: Match) -> Path | MapSpec:
        if match.state == PLAYING:
            return MatchSpec.model_validate(match.spec).map
        return path_of_record(session, self._season, match.id)


def _wanted(session: Session) -> tuple[list[Order], list[Order]]:
    """Return what people will ask for: of live matches, and of those that are over and may be watched.

    The first playing of a game of a ladder is hidden, and has the map of the second one.
    """
    live, over = list_matches(session, state=PLAYING), perhaps_shown(session)
    seen, twins = seen_by(session, [*live, *over], None), twins_of(session, live)
    maps = [(LIVE, match.id, match) for match in live if not seen[match.id].live]
    hidden = ((match, twins.get(match.id)) for match in live if seen[match.id].live not in ("", FROZEN))
    maps += [(LIVE, twin.id, match) for match, twin in hidden if twin and twin.state == WAITING]
    shown = [match for match in over if not seen[match.id].record]
    return maps, [(product, match.id, match) for match in shown for product in OVER]
