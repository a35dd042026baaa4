"""Seasons whose organizer edits the rules."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sqlalchemy import func, select
from tests.leaderboard.conductor.conducted import Conducted, conducting
from tests.leaderboard.seasons_made import make_season

from wildscav_leaderboard.conductor.editions import (
    EditionChange,
    apply_editions,
    begin_editions,
)
from wildscav_leaderboard.matches.models import Match
from wildscav_leaderboard.organizing import finalizing
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.settings import SETTINGS_FILE
from wildscav_leaderboard.visibility import PUBLIC

EDITS = {
    "the suite": ("tiny.toml", "time_limit = 4 }\n\n[tracks.battle]", "time_limit = 5 }\n\n[tracks.battle]"),
    "rounds": (
        SETTINGS_FILE,
        'suite = "tiny.toml"\n\n[tracks.battle]',
        'suite = "tiny.toml"\nrounds = 2\n\n[tracks.battle]',
    ),
    "limits": ("tiny.toml", "[tracks.battle]", 'limits = { memory = "128MiB" }\n\n[tracks.battle]'),
    "a model": (SETTINGS_FILE, "[quotas]", '[model]\nurl = "http://host/v1"\nname = "tiny"\n\n[quotas]'),
    "the sandbox": (SETTINGS_FILE, 'sandbox = "process"', 'sandbox = "bubblewrap"'),
}


@contextmanager
def played_by_two(folder: Path) -> Iterator[Conducted]:
    """A season in which the foxes and the owls have played navigation."""
    with conducting(make_season(folder / "season")) as conducted:
        conducted.active("foxes")
        conducted.active("owls")
        play(conducted)
        yield conducted


def play(season: Conducted, score: float = 1.0) -> int:
    """Play whatever waits and can be played, and bring the boards up to date; return how many matches."""
    count = 0
    while taken := season.take_matches(8):
        for attempt, _ in taken:
            season.wait(1)
            assert season.played(attempt, score)
        count += len(taken)
    season.refresh()
    return count


def edit(season: Conducted, file: str, old: str, new: str) -> list[EditionChange]:
    """Edit a file, and start the season again."""
    rewrite(season, file, old, new)
    return season.write(lambda session: begin_editions(session, season.season, season.now))


def rewrite(season: Conducted, file: str, old: str, new: str) -> None:
    """Edit a file, without the conductor's knowledge."""
    path = season.season.folder / file
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    season.season = Season.open(season.season.folder)


def apply(season: Conducted) -> list[EditionChange]:
    return season.write(lambda session: apply_editions(session, season.season, "anna", season.now))


def ranked(season: Conducted, audience: str = PUBLIC) -> list[tuple[str, int]]:
    """The teams that have a rank, and their matches."""
    found = season.board("navigation", audience)
    return [] if found is None else [(row.team, row.matches) for row in found.rows if row.rank is not None]


def counts(season: Conducted) -> dict[str, int]:
    with season.database.reading() as session:
        found = session.execute(select(Match.state, func.count()).group_by(Match.state))
        return {state: count for state, count in found}  # noqa: C416


def finalize(season: Conducted, best: int = 1) -> finalizing.Ending:
    later = season.season.settings.closes
    with season.database.writing() as session:
        finalizing.begin(session, season.season, "anna", best, later, early=False)
        return finalizing.advance(session, season.season, "anna", later)


def navigation(season: Conducted) -> str:
    """The settings of navigation."""
    text = (season.season.folder / SETTINGS_FILE).read_text()
    return text[text.index("[tracks.navigation]") : text.index("[tracks.battle]")]
