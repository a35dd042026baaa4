"""Suites: the competition's numbers, the same matches for everybody, and maps that nobody trained on."""

from collections import Counter
from hashlib import blake2b
from typing import get_type_hints

import pytest

from wildscav_engine.maps import map_of
from wildscav_engine.maps.layout import lay_out
from wildscav_engine.maps.walk import find_path
from wildscav_engine.simulation.setup.match_setup import plan_match
from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.cli.commands.evaluate import evaluate
from wildscav_evaluator.suites.suite import EVALUATION_MAPS, SUITES, suite

BOTH = [(name, track) for name in SUITES for track in SUITES[name].tracks]


@pytest.mark.parametrize(("name", "track"), BOTH)
def test_every_suite_is_a_function_of_its_seed(name: str, track: str) -> None:
    specs = suite(track, name, 7)

    assert specs == suite(track, name, 7)
    assert specs != suite(track, name, 8)
    assert {spec.track for spec in specs} == {track}
    assert all(spec.map.seed >= EVALUATION_MAPS for spec in specs)
    assert len({(spec.map.seed, spec.seed) for spec in specs}) == len(specs)


FROZEN = {
    "quick": {
        "navigation": "7ac0c519",
        "gathering": "0fafeedf",
        "capture": "4c124f43",
        "battle": "48e518af",
        "royale": "afd4d962",
    },
    "official": {
        "navigation": "0b4c510c",
        "gathering": "45600c72",
        "battle": "0d7bff8e",
        "capture": "26721190",
        "royale": "e47eb9cc",
    },
    "wild": {
        "navigation": "308301c4",
        "capture": "9e130948",
        "gathering": "69da16be",
        "battle": "37d1bc8c",
        "royale": "2d9bbac9",
    },
    "fair": {"gathering": "7506cc1d", "battle": "be6b623b", "royale": "338443c1"},
    "reading": {
        "navigation": "959864b9",
        "gathering": "9c5247bf",
        "capture": "4cd89ddd",
        "battle": "7c03bdc6",
        "royale": "33c5591d",
    },
}


@pytest.mark.parametrize(("name", "track"), BOTH)
def test_the_matches_of_a_suite_stay_as_they_are(name: str, track: str) -> None:
    """What was scored by a suite is compared with what will be: other matches need another name."""
    specs = "".join(spec.model_dump_json() for spec in suite(track, name, 0))
    assert blake2b(specs.encode(), digest_size=4).hexdigest() == FROZEN[name][track]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "track"), BOTH)
def test_maps_of_a_suite_can_be_made(name: str, track: str) -> None:
    maps = list(dict.fromkeys(match.map for match in suite(track, name, 3)))
    for spec in maps[::8]:
        layout = lay_out(spec.config, spec.seed)

        in_towns = len(layout.country.sites) if layout.country else 0
        assert 0 < len(layout.houses) <= spec.config.houses + in_towns


def test_the_maps_of_a_suite_are_of_many_kinds() -> None:
    maps = {match.map.config for seed in range(3) for match in suite("battle", "official", seed)}

    assert {config.density for config in maps} == {"low", "high"}
    assert {config.relief for config in maps} == {0.5, 1.0, 1.5, 2.0}
    assert {config.ruggedness for config in maps} == {0.1, 0.4, 0.7, 1.0}


def test_tracks_and_suites_share_no_maps() -> None:
    seeds = [{spec.map.seed for spec in suite(track, name, 0)} for name, track in BOTH]

    assert len(set().union(*seeds)) == sum(map(len, seeds))


@pytest.mark.parametrize("seed", [0, -1, 2**64, 2**200 + 1])
def test_a_seed_may_be_any_whole_number(seed: int) -> None:
    assert suite("navigation", "quick", seed)


@pytest.mark.parametrize(
    ("track", "maps", "episodes", "seconds"),
    [
        ("navigation", 10, 10, 300.0),
        ("gathering", 10, 10, 600.0),
        ("battle", 10, 1, 900.0),
    ],
)
def test_the_official_suite_has_the_counts_and_limits_of_the_competition(
    track: str, maps: int, episodes: int, seconds: float
) -> None:
    specs = suite(track, "official", 0)

    assert Counter(Counter(spec.map for spec in specs).values()) == {episodes: maps}
    assert {spec.time_limit for spec in specs} == {seconds}
    assert {spec.frames_per_action for spec in specs} == {5}


def test_official_gathering_draws_its_supplies_from_the_competitions_choices() -> None:
    waves, spacings = [], set()
    for seed in range(5):
        for spec in suite("gathering", "official", seed):
            assert spec.supplies is not None
            assert spec.supplies.outdoor_quantity == (1, 5)
            assert spec.supplies.indoor_quantity == (10, 50)
            waves += spec.supplies.waves
            spacings.add(spec.supplies.spacing)

    offsets = {-20.0, 0.0, 20.0}
    assert {wave.center for wave in waves} == {(x, z) for x in offsets for z in offsets}
    assert {wave.radius for wave in waves} == {10.0, 30.0, 50.0, 70.0}
    assert {wave.outdoor_richness for wave in waves} == {10.0, 20.0, 30.0}
    assert {wave.indoor_richness for wave in waves} == {50.0, 70.0, 90.0}
    assert spacings == {5.0, 10.0, 15.0, 20.0}
    assert {wave.time for wave in waves} == {0.0}


def test_official_battle_has_nine_robots_and_one_refresh_at_a_random_house() -> None:
    specs = suite("battle", "official", 0) + suite("battle", "official", 1)

    for spec in specs:
        assert len(spec.seats) == 10
        assert spec.seats.count(SUBMISSION) == 1
        assert {"fighter", "gatherer"} <= set(spec.seats)
        assert spec.supplies is not None
        first, refresh = spec.supplies.waves
        assert (first.time, first.radius, first.center, spec.supplies.spacing) == (
            0.0,
            100.0,
            (0.0, 0.0),
            5.0,
        )
        assert (refresh.time, refresh.center) == (600.0, None)
        assert refresh.radius in {30.0, 50.0, 70.0}
        assert first.indoor_richness in {70.0, 80.0, 90.0}
    assert len({spec.seats.index(SUBMISSION) for spec in specs}) > 3, "no agent may count on its seat"


@pytest.mark.parametrize("name", ["quick", "official"])
def test_the_suites_of_plain_country_have_every_track(name: str) -> None:
    assert set(SUITES[name].tracks) == set(TRACKS)


@pytest.mark.parametrize("track", ["battle", "royale"])
def test_wild_fights_are_about_a_hot_spot_that_moves_to_the_end(track: str) -> None:
    for spec in suite(track, "wild", 0):
        assert len(spec.seats) == 10
        assert spec.seats.count(SUBMISSION) == 1
        assert spec.map.config.size <= 160
        assert spec.supplies is not None
        hot_spot = spec.supplies.hot_spot
        assert hot_spot is not None
        left = spec.time_limit - hot_spot.interval * hot_spot.places
        assert 0 <= left < hot_spot.interval


@pytest.mark.parametrize("track", ["navigation", "capture"])
def test_wild_ways_lead_through_mazes_to_hidden_targets(track: str) -> None:
    for spec in suite(track, "wild", 0):
        assert spec.map.config.country is not None
        assert spec.map.config.country.hidden_targets


def test_an_unknown_suite_or_track_is_named_with_those_that_there_are() -> None:
    with pytest.raises(
        ValueError, match="no suite 'slow'; the suites are quick, official, wild, fair, reading"
    ):
        suite("navigation", "slow", 0)
    with pytest.raises(ValueError, match="no track 'fishing'; it has navigation"):
        suite("fishing", "quick", 0)


def test_the_help_of_the_command_names_the_suites_that_there_are() -> None:
    annotation = get_type_hints(evaluate, include_extras=True)["suite"]

    assert all(f"{name}: " in annotation.__metadata__[0].help for name in SUITES)


@pytest.mark.parametrize(
    ("track", "matches"),
    [
        ("navigation", 1),
        pytest.param("navigation", 8, marks=pytest.mark.slow),  # on two maps
        pytest.param("capture", 8, marks=pytest.mark.slow),
    ],
)
def test_a_way_leads_from_each_start_to_the_target_of_a_wild_match(track: str, matches: int) -> None:
    for spec in suite(track, "wild", 1)[:matches:2]:
        game_map = map_of(spec.map)
        setup = plan_match(spec, game_map)
        assert setup.target is not None
        assert len(setup.starts) == len(spec.seats)
        for seat, start in enumerate(setup.starts):
            path = find_path(game_map.graph, start, setup.target)
            assert path is not None, (spec.map.seed, spec.seed, seat)
