"""The ratings of a tournament follow from its results, and from nothing else."""

from pathlib import Path

import pytest
from tests.evaluator.tournaments.results_by_hand import results_of, seat

from wildscav.errors import UserError
from wildscav_evaluator.output.layout import TOURNAMENT_FILE
from wildscav_evaluator.output.results import Results, TournamentSettings
from wildscav_evaluator.scores.expected_matches import match_counts
from wildscav_evaluator.tournaments.tournament_file import check_tournament, tournament_of


@pytest.fixture
def results() -> Results:
    """Ada wins twelve matches of fourteen; one more was broken by the platform."""
    seats = {
        index: [seat(0, "ada", supplies=float(index % 7)), seat(1, "bob", supplies=0.5)]
        for index in range(14)
    }
    return results_of("battle", seats | {14: []})


def test_it_counts_matches_and_tells_who_is_ahead(results: Results) -> None:
    found = tournament_of(results)
    assert (found.matches, found.failed) == (14, 1)
    best, other = found.ratings.standings
    assert (best.entrant, best.matches, best.wins) == ("ada", 14, 12)
    assert (other.entrant, other.wins) == ("bob", 2)
    assert best.rating > 1500 > other.rating
    assert {one.name: one.score.mean for one in found.entrants if one.score} == {"ada": 3.0, "bob": 0.5}


def test_a_schedule_of_a_later_version_is_checked_by_the_wildscav_that_made_it(
    results: Results, tmp_path: Path
) -> None:
    later = results.model_copy(update={"tournament": TournamentSettings(seats=2, schedule=3)})
    with pytest.raises(UserError, match=r"version 3 of its schedule, .* check it with the Wildscav that"):
        match_counts(tmp_path, later)


def test_only_ratings_that_follow_from_the_results_are_accepted(results: Results, tmp_path: Path) -> None:
    assert "the ratings are missing" in check_tournament(tmp_path, results)
    found = tournament_of(results)
    found.write(tmp_path / TOURNAMENT_FILE)
    assert check_tournament(tmp_path, results) == ""

    best, other = found.ratings.standings
    lie = found.ratings.model_copy(
        update={"standings": (best, other.model_copy(update={"rating": other.rating + 1}))}
    )
    found.model_copy(update={"ratings": lie}).write(tmp_path / TOURNAMENT_FILE)
    assert "are not those that the results" in check_tournament(tmp_path, results)

    (tmp_path / TOURNAMENT_FILE).write_text("{}")
    assert "is not the file of a tournament" in check_tournament(tmp_path, results)


def test_an_evaluation_has_no_ratings(results: Results, tmp_path: Path) -> None:
    alone = results.model_copy(update={"tournament": None})
    assert check_tournament(tmp_path, alone) == ""
    with pytest.raises(ValueError, match="not those of a tournament"):
        tournament_of(alone)
