"""Rulings on where supply boxes are put, when they appear, and how much they hold."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.builders import RICH, WILD, act, make_match, place

from wildscav_engine.geometry.terrain import water_at
from wildscav_engine.maps import GameMap, generate_map, map_of, map_spec
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.setup.starts import usable_place
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave


def test_numbers_of_boxes_do_not_tell_where_they_lie() -> None:
    match = make_match("gathering", supplies=RICH)
    supplies = match.state.supplies
    there = supplies.quantity[0] > 0
    serials = supplies.serial[0, there]
    assert sorted(serials) == list(range(len(serials)))
    assert abs(np.corrcoef(serials, supplies.position[0, there, 2])[0, 1]) < 0.4


def test_a_wave_appears_at_its_second() -> None:
    waves = (
        SupplyWave(center=(0, 0), radius=1000, outdoor_richness=50),
        SupplyWave(time=2.0, center=(0, 0), radius=1000, outdoor_richness=50),
    )
    match = make_match("gathering", supplies=SupplyConfig(waves=waves, spacing=1))
    late = match.state.supplies.appears[0] == 100
    assert late.any()
    place(match, 0, match.state.supplies.position[0, late][0])
    match.state.supplies.quantity[0, ~late] = 0
    act(match, 19, seat_0={"pick_up": 1})
    assert match.state.agents.supplies[0, 0] == 0
    act(match, 1, seat_0={"pick_up": 1})
    assert match.state.agents.supplies[0, 0] > 0


def test_a_wave_without_a_center_lies_around_an_indoor_place() -> None:
    game_map = generate_map(MapConfig(size=80, houses=4), 5)
    supplies = SupplyConfig(waves=(SupplyWave(center=None),))
    match = Match(MatchSpec(track="battle", map=game_map.spec, supplies=supplies), game_map)
    center = match.start_info(0).waves[0].center
    assert center in {(x, z) for x, _, z in game_map.indoor.tolist()}


class Laid(NamedTuple):
    """The boxes of a match at its start."""

    places: np.ndarray  # (B, 3) m
    quantity: np.ndarray  # (B,)
    appears: np.ndarray  # (B,) frame
    inside: np.ndarray  # (B,) whether it lies at an indoor place


def laid(spec: MatchSpec) -> Laid:
    game_map = map_of(spec.map)
    supplies = Match(spec, game_map).state.supplies
    there = supplies.quantity[0] > 0
    indoors = {tuple(place) for place in np.float32(game_map.indoor).tolist()}
    places = supplies.position[0, there]
    inside = np.array([tuple(place) in indoors for place in places.tolist()])
    return Laid(places, supplies.quantity[0, there], supplies.appears[0, there], inside)


@pytest.mark.parametrize("track", ["gathering", "battle"])
@pytest.mark.parametrize("map_seed", range(3))
def test_every_box_can_be_reached_and_brought_away(track: str, map_seed: int) -> None:
    game_map = map_of(WILD.model_copy(update={"seed": map_seed}))
    graph = game_map.graph
    joined = {tuple(place) for place in np.float32(graph.positions(np.nonzero(graph.connected)[0])).tolist()}
    boxes = laid(MatchSpec(track=track, map=game_map.spec, seed=4))

    assert len(boxes.places) > 10
    assert all(tuple(place) in joined for place in boxes.places.tolist())


@pytest.mark.parametrize("track", ["gathering", "battle"])
@pytest.mark.parametrize("map_id", [102, 103, 104])
def test_indoor_boxes_are_fewer_and_hold_much_more(track: str, map_id: int) -> None:
    boxes = laid(MatchSpec(track=track, map=map_spec(map_id), seed=map_id))

    assert 0 < boxes.inside.sum() < (~boxes.inside).sum()
    assert boxes.quantity[boxes.inside].mean() > 5 * boxes.quantity[~boxes.inside].mean()
    assert boxes.quantity[boxes.inside].min() > boxes.quantity[~boxes.inside].max()


def test_indoor_boxes_of_a_wave_lie_five_metres_apart_in_all_houses() -> None:
    game_map = map_of(WILD)
    boxes = laid(MatchSpec(track="gathering", map=WILD, supplies=RICH))
    indoor = boxes.places[boxes.inside]

    apart = np.linalg.norm(indoor[:, None] - indoor[None], axis=2) + 100.0 * np.eye(len(indoor))
    assert apart.min() >= 5.0
    # With a richness of 100 % no place indoors is farther from a box.
    for spot in game_map.indoor:
        assert np.linalg.norm(indoor - spot, axis=1).min() < 5.0


def test_amounts_are_as_likely_all_over_their_range() -> None:
    boxes = laid(MatchSpec(track="gathering", map=map_spec(102), supplies=RICH))

    counts = np.bincount(boxes.quantity[~boxes.inside], minlength=6)[1:]
    assert counts.min() > 0.8 * counts.mean()
    assert boxes.quantity[boxes.inside].mean() == pytest.approx(30.0, abs=5.0)


REFRESHED = SupplyConfig(
    waves=(
        SupplyWave(center=(-20.0, -20.0), radius=12.0, outdoor_richness=50.0, indoor_richness=0.0),
        SupplyWave(time=30.0, center=(20.0, 15.0), radius=12.0, outdoor_richness=50.0, indoor_richness=0.0),
    ),
    spacing=4.0,
)


def test_a_refresh_adds_boxes_around_its_own_center_at_its_second() -> None:
    boxes = laid(MatchSpec(track="battle", map=WILD, supplies=REFRESHED))

    assert set(boxes.appears) == {0, 30 * 50}
    for frame, center in ((0, (-20.0, -20.0)), (1500, (20.0, 15.0))):
        away = np.hypot(*(boxes.places[boxes.appears == frame][:, ::2] - center).T)
        assert len(away) >= 8
        assert np.median(away) < 24.0  # two standard deviations of the heat map
        assert away.max() < 48.0


@pytest.fixture(scope="module")
def meadow() -> GameMap:
    """A hundred metres of open ground, nearly all of it places."""
    return generate_map(MapConfig(size=100, relief=0.3, water=0.0, houses=0, vegetation=0.1), 5)


def boxes_of(game_map: GameMap, wave: SupplyWave, spacing: float, seed: int = 0) -> NDArray[np.float32]:
    """Where the boxes of a wave are, (N, 3) m."""
    config = SupplyConfig(waves=(wave,), spacing=spacing)
    spec = MatchSpec(track="gathering", map=game_map.spec, seats=("walker",), supplies=config, seed=seed)
    supplies = Match(spec, game_map).state.supplies
    return supplies.position[0][supplies.quantity[0] > 0]


@pytest.mark.parametrize("spacing", [1.0, 1.5, 2.0, 3.0, 4.0])
def test_boxes_are_as_dense_as_the_grid(meadow: GameMap, spacing: float) -> None:
    share_of_ground = len(meadow.ground_points[len(meadow.outdoor) :]) / 100**2
    expected = 0.5 * share_of_ground * (100 / spacing) ** 2

    everywhere = SupplyWave(center=(0.0, 0.0), radius=1000.0, outdoor_richness=50.0, indoor_richness=0.0)
    assert share_of_ground > 0.8
    assert len(boxes_of(meadow, everywhere, spacing)) == pytest.approx(expected, rel=0.15)


@pytest.mark.parametrize("spacing", [4.0, 5.0, 10.0, 20.0])
def test_boxes_thin_out_with_the_distance_as_the_rules_say(meadow: GameMap, spacing: float) -> None:
    """A place in each square has a box with the probability richness · exp(-d² / 2r²), here r = 20 m."""
    wave = SupplyWave(center=(10.0, -5.0), radius=20.0, outdoor_richness=50.0, indoor_richness=0.0)
    places = meadow.ground_points if spacing <= 4.0 else meadow.outdoor
    squares = np.floor(places[:, [0, 2]] / spacing)
    _, first = np.unique(squares, axis=0, return_index=True)
    away, rings = np.hypot(places[first, 0] - 10.0, places[first, 2] + 5.0), (0.0, 15.0, 30.0, 45.0, 100.0)
    chance = 0.5 * np.exp(-(away**2) / (2.0 * 20.0**2))
    both = (chance, chance * (1.0 - chance))
    expected, spread = (np.histogram(away, rings, weights=one)[0] for one in both)
    counts, seeds = np.zeros(len(rings) - 1), 60
    for seed in range(seeds):
        boxes = boxes_of(meadow, wave, spacing, seed)
        counts += np.histogram(np.hypot(boxes[:, 0] - 10.0, boxes[:, 2] + 5.0), rings)[0]
    assert (np.abs(counts - seeds * expected) < 4.0 * np.sqrt(seeds * spread)).all(), (counts, expected)


def test_a_grid_wider_than_the_places_lie_apart_needs_no_others(meadow: GameMap) -> None:
    fresh = replace(meadow)
    boxes_of(fresh, SupplyWave(center=(0.0, 0.0)), 5.0)
    assert "ground_points" not in vars(fresh)


def test_boxes_of_a_fine_grid_lie_where_one_gets_to_and_away() -> None:
    game_map = generate_map(MapConfig(size=80, relief=1.5, ruggedness=0.8, water=0.15, houses=4), 3)
    points = game_map.ground_points[len(game_map.outdoor) :: 7]

    assert len(points) > 100
    for x, y, z in points.tolist():
        assert water_at(game_map.world, x, z) == -np.inf
        assert usable_place(game_map, (x, y, z), None) == (x, y, z)
