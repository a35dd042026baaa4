"""The explanation under the standings of a tournament."""

from types import SimpleNamespace
from typing import cast

import pytest

from wildscav_evaluator.cli.result_tables.standings import LEGEND, legend
from wildscav_evaluator.ratings.matches import RatedMatch
from wildscav_evaluator.ratings.standings import rate
from wildscav_evaluator.tournaments.tournament_file import Tournament


def played(*pairs: tuple[str, str]) -> Tournament:
    """Return a tournament in which the first of each pair beat the second."""
    matches = [RatedMatch(game=game, teams=((a,), (b,)), places=(1, 2)) for game, (a, b) in enumerate(pairs)]
    return cast(Tournament, SimpleNamespace(ratings=rate(matches)))


def test_entrants_that_never_met_are_not_compared() -> None:
    text = legend(played(("ada", "bob"), ("cy", "dee")))
    assert text.startswith(LEGEND)
    assert "2 groups that never met each other" in text


@pytest.mark.parametrize("last", [("cy", "ada"), ("cy", "bob")])
def test_entrants_that_met_through_others_need_no_explanation(last: tuple[str, str]) -> None:
    assert legend(played(("ada", "bob"), last)) == LEGEND
