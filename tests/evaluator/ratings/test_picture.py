"""The picture of standings: what is in it, and that it depends on the standings alone."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from PIL import Image
from tests.evaluator.ratings.simulated_tournaments import simulated_tournament

from wildscav_engine.simulation.robots.decide import ROBOTS
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_evaluator.ratings.picture import (
    LONGEST_COLUMN,
    band_lines,
    draw_standings,
    shares_of_points,
)
from wildscav_evaluator.ratings.standings import rate

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
