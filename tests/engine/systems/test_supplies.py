"""Rulings on supply boxes: where they lie, who gets them, when they appear."""

import numpy as np
import pytest

from builders import act, flat_world, make_match, map_from, place
from wildscav_engine.maps import generate_map
from wildscav_engine.match import Match
from wildscav_engine.spec import MapConfig, MatchSpec, SupplyConfig, SupplyWave


def boxes_at(match: Match, *places: tuple[float, float, float], quantity: int = 3) -> None:
    """Lay exactly these boxes."""
    supplies = match.state.supplies
    supplies.quantity[:] = 0
    for slot, spot in enumerate(places):
        supplies.position[0, slot] = spot
        supplies.quantity[0, slot] = quantity
        supplies.appears[0, slot] = 0


RICH = SupplyConfig(
    waves=(SupplyWave(center=(0, 0), radius=1000, outdoor_richness=50, indoor_richness=100),), spacing=1
)


def gathering(seats: int = 1) -> Match:
    match = make_match("gathering", seats=seats, supplies=RICH)
    place(match, 0, (0, 0, 0))
    return match


@pytest.mark.parametrize(("distance", "taken"), [(0.0, 3), (1.49, 3), (1.51, 0)])
def test_a_box_is_picked_up_within_a_metre_and_a_half(distance: float, taken: int) -> None:
    match = gathering()
    boxes_at(match, (distance, 0, 0))
    act(match, 1, seat_0={"pick_up": 1})
    assert match.state.agents.supplies[0, 0] == taken


def test_a_box_on_the_next_storey_is_out_of_reach() -> None:
    match = gathering()
    boxes_at(match, (0, 3, 0))
    act(match, 1, seat_0={"pick_up": 1})
    assert match.state.agents.supplies[0, 0] == 0


def test_without_the_action_nothing_is_picked_up() -> None:
    match = gathering()
    boxes_at(match, (0, 0, 0))
    act(match, 3)
    assert match.state.agents.supplies[0, 0] == 0
    assert match.seen.can_pick_up[0, 0]


def test_a_frame_takes_one_box_the_nearest_first() -> None:
    match = make_match("gathering", supplies=RICH, frames_per_action=1)
    place(match, 0, (0, 0, 0))
    boxes_at(match, (1, 0, 0), (0.5, 0, 0), (1.2, 0, 0))
    for left in ([3, 0, 3], [0, 0, 3], [0, 0, 0]):
        act(match, 1, seat_0={"pick_up": 1})
        assert match.state.supplies.quantity[0, :3].tolist() == left


def test_two_at_one_box_get_it_once() -> None:
    match = gathering(seats=2)
    place(match, 0, (0, 0, 0))
    place(match, 1, (1, 0, 0))
    boxes_at(match, (0.5, 0, 0))
    act(match, 1, seat_0={"pick_up": 1}, seat_1={"pick_up": 1})
    assert match.state.agents.supplies[0].sum() == 3


@pytest.mark.parametrize(("one", "other"), [(0, 1), (3, 4), (9, 0), (2, 7)])
def test_no_seat_has_an_advantage_over_another(one: int, other: int) -> None:
    won = {one: 0, other: 0}
    match = make_match("gathering", seats=10, supplies=RICH, frames_per_action=1, time_limit=60)
    for seat in range(10):
        place(match, seat, (seat - 15, 0, 10))
    place(match, one, (0, 0, 0))
    place(match, other, (1, 0, 0))
    for _ in range(400):
        boxes_at(match, (0.5, 0, 0))
        act(match, 1, **{f"seat_{seat}": {"pick_up": 1} for seat in won})
        for seat in won:
            won[seat] += int(match.state.agents.gained[0, seat] > 0)
    assert won[one] + won[other] == 400
    assert abs(won[one] - won[other]) < 80  # four standard deviations


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


def test_quantities_stay_in_their_ranges_and_indoor_boxes_hold_more() -> None:
    game_map = generate_map(MapConfig(size=80, houses=4), 5)
    spec = MatchSpec(track="gathering", map=game_map.spec, supplies=RICH.model_copy(update={"spacing": 4.0}))
    match = Match(spec, game_map)
    supplies = match.state.supplies
    indoors = {tuple(place) for place in game_map.indoor.tolist()}
    inside = np.array([tuple(place) in indoors for place in supplies.position[0].tolist()])
    there = supplies.quantity[0] > 0
    assert set(np.unique(supplies.quantity[0, there & ~inside])) == {1, 2, 3, 4, 5}
    assert supplies.quantity[0, there & inside].min() >= 10
    assert supplies.quantity[0, there & inside].max() <= 50
    assert (there & inside).sum() == len(game_map.indoor)  # 100 % of the indoor places


def test_boxes_are_thickest_around_the_center_of_the_heat_map() -> None:
    world = flat_world(200)
    spots = np.array([[x, 0, z] for x in range(-98, 99, 4) for z in range(-98, 99, 4)], float)
    game_map = map_from(world._replace(spawns=spots))
    wave = SupplyWave(center=(40, 0), radius=20, outdoor_richness=50)
    spec = MatchSpec(
        track="gathering", map=game_map.spec, supplies=SupplyConfig(waves=(wave,), spacing=4), seed=2
    )
    match = Match(spec, game_map)
    boxes = match.state.supplies.position[0][match.state.supplies.quantity[0] > 0]
    away = np.hypot(boxes[:, 0] - 40, boxes[:, 2])
    # Of a two-dimensional normal distribution, 39 % lie within one deviation and 99 % within three.
    assert np.mean(away < 20) == pytest.approx(0.39, abs=0.12)
    assert np.mean(away < 60) > 0.96
    # 50 % of 2πr² / spacing² grid points.
    assert len(boxes) == pytest.approx(0.5 * 2 * np.pi * 20**2 / 4**2, rel=0.3)


def test_a_wave_without_a_center_lies_around_an_indoor_place() -> None:
    game_map = generate_map(MapConfig(size=80, houses=4), 5)
    supplies = SupplyConfig(waves=(SupplyWave(center=None),))
    match = Match(MatchSpec(track="battle", map=game_map.spec, supplies=supplies), game_map)
    center = match.start_info(0).waves[0].center
    assert center in {(x, z) for x, _, z in game_map.indoor.tolist()}
