"""The stored ratings of a tournament, and their picture."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from PIL import Image
from tests.evaluator.ratings.simulated_tournaments import simulated_tournament

from wildscav_engine.simulation.robots.decide import ROBOTS
from wildscav_evaluator.ratings.ladder import Skill, ladder
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_evaluator.ratings.picture import LONGEST_COLUMN, band_lines, draw_standings, shares_of_points
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


DUELS = [RatedMatch(game, (("a",), ("$b_1$ and $x",)), (1, 2)) for game in range(8)]


def test_equal_standings_give_equal_files_whatever_settings_the_user_has(tmp_path: Path) -> None:
    first = draw_standings(rate(DUELS), "battle", tmp_path / "first.png")
    with mpl.rc_context({"font.size": 20.0, "axes.facecolor": "black", "savefig.dpi": 30}):
        second = draw_standings(rate(DUELS), "battle", tmp_path / "second.png")

    assert first.read_bytes() == second.read_bytes()
    assert draw_standings(rate(DUELS), "royale", first).read_bytes() != second.read_bytes()


@pytest.mark.parametrize(("entrants", "games"), [(2, 1), (3, 10), (30, 40)])
def test_more_entrants_make_a_larger_picture_on_light_ground(
    tmp_path: Path, entrants: int, games: int
) -> None:
    standings = rate(
        simulated_tournament([0.0] * entrants, 0, games=games, seats=min(entrants, 8), repeats=1)
    )
    with Image.open(draw_standings(standings, "battle", tmp_path / "standings.png")) as picture:
        assert picture.format == "PNG"
        assert picture.width >= 1200
        assert picture.height > 33 * len(standings.standings)  # pixels of a row
        assert picture.convert("RGB").getpixel((0, 0)) == (255, 255, 255)


def test_no_robot_s_name_is_shortened_above_its_column() -> None:
    assert max(len(f"robot:{name}") for name in ROBOTS) <= LONGEST_COLUMN


@pytest.mark.slow
def test_of_many_entrants_the_best_fifty_are_shown(tmp_path: Path) -> None:
    fifty, more = (
        rate(simulated_tournament([0.0] * count, 0, games=40, seats=8, repeats=1)) for count in (50, 120)
    )
    heights = []
    for standings in (fifty, more):
        with Image.open(draw_standings(standings, "royale", tmp_path / "standings.png")) as picture:
            heights.append(picture.height)

    assert heights[1] == pytest.approx(heights[0], abs=10)  # longer names


def test_entrants_of_several_groups_are_drawn(tmp_path: Path) -> None:
    apart = [RatedMatch(20 + game, (("x",), ("y",)), (1, 1)) for game in range(8)]

    assert draw_standings(rate([*DUELS, *apart]), "battle", tmp_path / "standings.png").is_file()


def test_overlapping_bands_have_lanes_of_their_own() -> None:
    bands = [("a", "b", "c"), ("b", "c", "d"), ("d", "e"), ("f",), ("g", "h")]

    # Lane, first row, last row, band. The single f needs no bar, and h is below the last row.
    assert band_lines(bands, "abcdefg") == [(0, 0, 2, 0), (1, 1, 3, 1), (0, 3, 4, 2), (0, 6, 6, 4)]


def test_the_matrix_has_the_share_of_points_of_the_row_against_the_column() -> None:
    standings = rate(
        [
            *(RatedMatch(game, (("a",), ("b",)), (1, 2)) for game in range(3)),
            RatedMatch(3, (("b",), ("a",)), (1, 1)),
            RatedMatch(4, (("b",), ("c",)), (1, 2)),
        ]
    )
    shares = shares_of_points(standings, standings.standings)

    assert [one.entrant for one in standings.standings] == ["a", "b", "c"]
    np.testing.assert_array_equal(
        shares, [[np.nan, 0.875, np.nan], [0.125, np.nan, 1.0], [np.nan, 0.0, np.nan]]
    )
