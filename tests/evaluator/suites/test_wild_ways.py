"""Every match of the suite ``wild`` with a target can be solved: a way leads there from each seat's start."""

from collections.abc import Iterable
from itertools import islice

import pytest

from wildscav_engine.maps import map_of
from wildscav_engine.maps.walk import find_path
from wildscav_engine.simulation.setup.match_setup import plan_match
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.suites.suite import suite


def check_ways(matches: Iterable[MatchSpec]) -> None:
    for spec in matches:
        game_map = map_of(spec.map)
        setup = plan_match(spec, game_map)
        assert setup.target is not None
        assert len(setup.starts) == len(spec.seats)
        for seat, start in enumerate(setup.starts):
            path = find_path(game_map.graph, start, setup.target)
            assert path is not None, (spec.map.seed, spec.seed, seat)


def test_a_way_leads_to_the_target_of_a_wild_match() -> None:
    check_ways(islice(suite("navigation", "wild", 0), 1))


@pytest.mark.slow
@pytest.mark.parametrize("track", ["navigation", "capture"])
def test_a_way_leads_to_the_target_of_more_wild_matches(track: str) -> None:
    check_ways(islice(suite(track, "wild", 1), 0, 8, 2))  # on two maps
