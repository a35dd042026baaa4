"""How far submissions are on their tracks, and which ladders wait for entrants."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.leaderboard.conductor.conducted import Conducted, conducting
from tests.leaderboard.seasons_made import make_season

from wildscav_leaderboard.boards.documents import TotalsView
from wildscav_leaderboard.boards.progress import missing_entrants, progress_of, totals_of
from wildscav_leaderboard.seasons.folder import Season

BOTH = ("navigation", "battle")


@pytest.fixture
def season(tmp_path: Path) -> Iterator[Conducted]:
    """A season whose ladder seats three, one of them the robot."""
    made = make_season(tmp_path / "season")
    battle = made.settings.tracks["battle"].model_copy(update={"seats": 3})
    tracks = {**made.settings.tracks, "battle": battle}
    with conducting(Season(made.folder, made.settings.model_copy(update={"tracks": tracks}))) as conducted:
        yield conducted


def missing(season: Conducted) -> dict[str, int]:
    with season.database.reading() as session:
        return missing_entrants(session, season.season)


def test_a_ladder_waits_for_teams_and_not_for_submissions(season: Conducted) -> None:
    assert missing(season) == {"battle": 2}
    season.active("foxes", BOTH)
    assert missing(season) == {"battle": 1}
    season.active("foxes", BOTH)  # those of one team never meet
    assert missing(season) == {"battle": 1}
    season.active("owls", ("navigation",))  # does not play there
    assert missing(season) == {"battle": 1}
    season.active("owls", ("battle",))
    assert missing(season) == {}


def test_progress_counts_what_is_played_of_what_is_planned(season: Conducted) -> None:
    number = season.active("foxes", BOTH)
    with season.database.reading() as session:
        found = progress_of(session, season.season, season.submission(number))
    assert [tuple(vars(one).values()) for one in found] == [("navigation", 0, 2, 0), ("battle", 0, 100, 1)]


def test_totals_of_a_suite_are_told_when_all_of_its_matches_are_over(season: Conducted) -> None:
    number = season.active("foxes", BOTH)
    found = []
    for score in (3.0, 5.0):
        ((attempt, _),) = season.take_matches(1)
        assert season.played(attempt, score)
        with season.database.reading() as session:
            found.append(totals_of(session, season.submission(number)))
    assert found == [[], [TotalsView(track="navigation", matches=2, score=4.0, faults={})]]


def test_whatever_takes_no_part_has_no_progress(season: Conducted) -> None:
    number = season.hand_in("foxes", BOTH)
    with season.database.reading() as session:
        assert progress_of(session, season.season, season.submission(number)) == []
