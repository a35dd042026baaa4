"""The stored ratings of a tournament."""

from pathlib import Path

import pytest
from tests.evaluator.ratings.simulated_tournaments import simulated_tournament

from wildscav_evaluator.ratings.ladder import Skill, ladder
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_evaluator.ratings.standings import Standings, ladder_skills, rate

MATCHES = simulated_tournament([2.0, 1.0, 0.0, -1.0, -2.0], seed=0, games=40)


def test_a_tournament_has_a_standing_for_each_entrant_best_first() -> None:
    found = rate(MATCHES)

    assert [one.entrant for one in found.standings] == ["00", "01", "02", "03", "04"]
    best = found.standings[0]
    assert (best.rank, best.group, best.bands[0]) == (1, 1, 1)
    assert best.low is not None
    assert best.high is not None
    assert best.low < best.rating < best.high
    assert best.games == 32  # 40 games of 4 of the 5
    assert best.matches == 128
    assert 1.0 < best.mean_place < 2.0
    assert best.expected_share == pytest.approx(best.share, abs=0.02)  # they met about equally often
    assert len(found.pairs) == 10
    assert sum(pair.wins + pair.ties + pair.losses for pair in found.pairs) == 160 * 6


def test_they_are_read_back_as_written_and_recomputed_exactly(tmp_path: Path) -> None:
    written = rate(MATCHES).write(tmp_path / "standings.json")

    assert Standings.read(written) == rate(MATCHES)


def test_only_the_ladder_depends_on_the_order_of_the_matches() -> None:
    shuffled = [*MATCHES[70:], *MATCHES[:70][::-1]]
    ordered, other = rate(MATCHES), rate(shuffled)

    assert [one.ladder for one in ordered.standings] != [one.ladder for one in other.standings]
    assert [one.model_copy(update={"ladder": None}) for one in ordered.standings] == [
        one.model_copy(update={"ladder": None}) for one in other.standings
    ]
    assert (ordered.bands, ordered.pairs) == (other.bands, other.pairs)


def test_the_ladder_can_be_continued_from_what_is_stored() -> None:
    stored = ladder_skills(rate(MATCHES[:80]).standings)
    continued = ladder(MATCHES[80:], start=stored)

    last = {one.entrant: Skill(one.ladder.mu, one.ladder.sigma) for one in rate(MATCHES).standings}
    assert {name: steps[-1].skill for name, steps in continued.items()} == last


def test_a_single_match_rates_but_ranks_nobody() -> None:
    found = rate([RatedMatch(0, (("a",), ("b",)), (2, 1))])

    assert [(one.entrant, one.ranks, one.low) for one in found.standings] == [
        ("b", "1–2", None),
        ("a", "1–2", None),
    ]
    assert found.bands == (("b", "a"),)


def test_entrants_of_different_groups_have_ranks_of_their_own() -> None:
    apart = [RatedMatch(game, (("x",), ("y",)), (1, 2)) for game in range(100, 130)]
    found = rate([*MATCHES, *apart])

    assert [(one.entrant, one.group, one.ranks) for one in found.standings[5:]] == [
        ("x", 2, "1"),
        ("y", 2, "2"),
    ]


def test_no_matches_are_no_standings() -> None:
    assert rate([]) == Standings(standings=(), bands=(), pairs=())


def test_only_the_pairs_of_the_best_hundred_are_stored() -> None:
    found = rate(simulated_tournament([0.0] * 101, seed=0, games=60, repeats=1))

    assert len(found.standings) == 101
    stored = {pair.first for pair in found.pairs} | {pair.second for pair in found.pairs}
    assert stored == {one.entrant for one in found.standings[:100]}


def test_shared_first_places_are_counted_beside_the_wins() -> None:
    pair = (("a",), ("b",))
    won, shared = RatedMatch(0, pair, (1, 2)), RatedMatch(1, pair, (1, 1))
    places = {one.entrant: one.first_places for one in rate([won, shared]).standings}

    assert places == {"a": "1+1", "b": "0+1"}
    assert rate([won]).standings[0].first_places == "1"
