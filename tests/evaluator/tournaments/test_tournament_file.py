"""The names, places and ratings of a tournament follow from its entrants and its results alone."""

from dataclasses import replace
from itertools import permutations
from pathlib import Path

import pytest
from tests.evaluator.results_by_hand import MODEL
from tests.evaluator.sample_agents import WALKER, Submit
from tests.evaluator.tournaments.results_by_hand import results_of, seat

from wildscav.errors import UserError
from wildscav_evaluator.output.layout import TOURNAMENT_FILE
from wildscav_evaluator.output.results import Results, SeatRow, TournamentSettings
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_evaluator.scores.expected_matches import match_counts
from wildscav_evaluator.scores.leaderboard import Found, latest_tournaments
from wildscav_evaluator.submissions.images import built_name
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.tournaments.names import groups_of, with_unique_names
from wildscav_evaluator.tournaments.rated_matches import rated_matches
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


def test_tournaments_with_and_without_a_model_both_stand_on_the_board(results: Results) -> None:
    both = (tournament_of(results), tournament_of(results.model_copy(update={"model": MODEL})))

    assert [one.model for one in both] == [None, MODEL]
    found = Found((), tuple((f"2030-01-0{day}", one) for day, one in enumerate(both, 1)), ())
    assert len(latest_tournaments(found)) == 2


def test_it_tells_by_which_interface_an_entrant_plays(results: Results) -> None:
    ada, bob = results.evaluations
    reads = results.model_copy(update={"evaluations": (ada.model_copy(update={"interface": "words"}), bob)})

    assert [one.interface for one in tournament_of(reads).entrants] == ["words", None]
    assert '"interface"' not in tournament_of(results).model_dump_json()


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


@pytest.fixture
def walker(submit: Submit) -> Submission:
    return submit("walker", WALKER)


def version_of(submission: Submission, version: str, digest: str) -> Submission:
    manifest = submission.manifest.model_copy(update={"version": version})
    return replace(submission, manifest=manifest, digest=digest * 32)


def names(*submissions: Submission, meet_own: bool = False) -> list[str]:
    return [one.name for one in with_unique_names(submissions, meet_own=meet_own)]


def test_entries_of_one_submission_are_told_apart_by_their_versions_or_else_their_files(
    walker: Submission,
) -> None:
    assert names(walker) == ["walker"], "entered once, it keeps its name"
    assert names(walker, version_of(walker, "2.0", "a")) == ["walker@1.0.0", "walker@2.0"]
    one, other = version_of(walker, "1", "a"), version_of(walker, "1", "b")
    assert names(one, other) == ["walker@1#aaaaaaaa", "walker@1#bbbbbbbb"]
    with pytest.raises(UserError, match="'walker' is entered twice with the same files; --meet-own"):
        names(walker, walker)
    assert names(walker, walker, meet_own=True) == ["walker@1.0.0#1", "walker@1.0.0#2"]


def test_names_do_not_depend_on_the_order_of_the_entrants(walker: Submission) -> None:
    entries = [walker, version_of(walker, "1.0.0", "c"), version_of(walker, "3", "d")]
    found = [with_unique_names(order, meet_own=False) for order in permutations(entries)]
    assert all(one == found[0] for one in found)


def test_entries_of_one_submission_form_a_group() -> None:
    assert groups_of(["bob", "robot:fighter", "walker@1#aa", "walker@1#bb", "walker@2"]) == [0, 1, 2, 2, 2]


def test_an_entry_runs_in_the_image_that_was_built_of_its_submission(walker: Submission) -> None:
    first, _ = with_unique_names([walker, version_of(walker, "2", "a")], meet_own=False)
    assert first.name != walker.name
    assert built_name(first) == built_name(walker)


ADA_AND_BOB = (("ada",), ("bob",))


@pytest.mark.parametrize(
    ("track", "seats", "teams", "places"),
    [
        (
            "battle",
            [seat(0, "ada", supplies=3.0), seat(1, "bob", supplies=7.0), seat(2, "cy", supplies=3.0)],
            (*ADA_AND_BOB, ("cy",)),
            (2, 1, 2),
        ),
        # A royale is won by the last one standing, and not by the richest.
        (
            "royale",
            [seat(0, "ada", points=9.0, placement=2.0), seat(1, "bob", points=1.0, placement=1.0)],
            ADA_AND_BOB,
            (2, 1),
        ),
        ("capture", [seat(0, "ada", time=60.0), seat(1, "bob", time=20.0)], ADA_AND_BOB, (2, 1)),
        # The seats of an entrant are one team.
        (
            "battle",
            [
                seat(number, ("ada", "bob")[number % 2], number % 2, supplies=4 + number % 2)
                for number in range(4)
            ],
            ADA_AND_BOB,
            (2, 1),
        ),
        (
            "battle",
            [seat(number, name, number // 2, supplies=-(number // 2)) for number, name in enumerate("abcd")],
            (("a", "b"), ("c", "d")),
            (1, 2),
        ),
    ],
    ids=["equal scores", "last one standing", "shorter time", "one entrant", "mixed"],
)
def test_the_team_with_the_better_score_has_the_better_place(
    track: str, seats: list[SeatRow], teams: tuple[tuple[str, ...], ...], places: tuple[int, ...]
) -> None:
    (match,) = rated_matches(results_of(track, {5: seats}), repeats=2)
    assert match == RatedMatch(2, teams, places)


def test_a_match_that_the_platform_broke_rates_nobody() -> None:
    seats = [seat(0, "ada", supplies=3.0), seat(1, "bob", supplies=7.0)]
    assert len(list(rated_matches(results_of("battle", {0: seats, 1: []}), repeats=2))) == 1
