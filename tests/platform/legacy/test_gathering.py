"""Supply gathering by the original's contract: where boxes lie, what is in them, who takes them."""

from typing import Any

import pytest
from tests.platform.legacy.helpers.commands import command, setup, vector
from tests.platform.legacy.helpers.competitor import Competitor

from wildscav_legacy.commander_pb2 import GameMode, GMCommand, SupplyInfo


def gathering(**fields: Any) -> GMCommand:
    return command(GameMode.SUP_GATHER_MODE, **fields)


def place_of(box: SupplyInfo) -> list[float]:
    return [box.supply_location.x, box.supply_location.y, box.supply_location.z]


def boxes_of(competitor: Competitor, asked: GMCommand) -> list[SupplyInfo]:
    competitor.begin(asked)
    return list(competitor.seen_by(0).supply_info_list)


def test_all_boxes_are_told_each_with_an_id_of_its_own(competitor: Competitor) -> None:
    boxes = boxes_of(competitor, gathering(supply_random_min=2, supply_random_max=4))
    assert len(boxes) > 20
    assert len({box.supply_id for box in boxes}) == len(boxes)
    # Indoors a box holds 10 by default, outdoors 2 to 4.
    assert {box.supply_quantity for box in boxes} == {2, 3, 4, 10}


def test_the_density_of_boxes_follows_the_spacing_of_the_grid(competitor: Competitor) -> None:
    counts = [
        len(boxes_of(competitor, gathering(supply_grid_length=spacing, supply_house_create_percent=0)))
        for spacing in (1, 2, 4)
    ]
    assert counts[0] / counts[1] == pytest.approx(4, rel=0.2)
    assert counts[1] / counts[2] == pytest.approx(4, rel=0.3)


def test_without_richness_there_are_no_boxes(competitor: Competitor) -> None:
    assert not boxes_of(competitor, gathering(supply_create_percent=0, supply_house_create_percent=0))


def test_outdoor_and_indoor_richness_and_quantities_are_apart(competitor: Competitor) -> None:
    indoor = boxes_of(
        competitor,
        gathering(supply_create_percent=0, supply_house_random_min=11, supply_house_random_max=12),
    )
    outdoor = boxes_of(competitor, gathering(supply_house_create_percent=0))
    assert {box.supply_quantity for box in indoor} == {11, 12}
    assert {box.supply_quantity for box in outdoor} == {1}


def test_boxes_are_thickest_around_the_middle_of_the_heat_map(competitor: Competitor) -> None:
    asked = gathering(supply_heatmap_radius=8, supply_grid_length=1, supply_house_create_percent=0)
    asked.supply_heatmap_center.CopyFrom(vector((20, 0, -20)))
    places = [place_of(box) for box in boxes_of(competitor, asked)]
    assert len(places) >= 3
    assert all((x - 20) ** 2 + (z + 20) ** 2 < 30**2 for x, _, z in places)


def test_who_stands_at_a_box_can_pick_it_up_and_then_it_is_gone(competitor: Competitor) -> None:
    asked = gathering(supply_random_min=1, supply_random_max=5, supply_house_create_percent=0)
    box = boxes_of(competitor, asked)[0]
    asked.agent_setups[0].start_location.CopyFrom(box.supply_location)
    before = boxes_of(competitor, asked)
    assert box in before
    assert competitor.seen_by(0).can_pickup
    competitor.act({0: {"collect": False}})
    assert competitor.seen_by(0).num_supply == 0
    competitor.act({0: {"collect": True}})
    after = list(competitor.seen_by(0).supply_info_list)
    taken = [one for one in before if one not in after]
    assert box.supply_id in {one.supply_id for one in taken}
    assert competitor.seen_by(0).num_supply == sum(one.supply_quantity for one in taken)


def test_shots_are_no_part_of_gathering(competitor: Competitor) -> None:
    competitor.begin(gathering(agents=[setup()]))
    competitor.act({0: {"shoot_gun": True}})
    assert competitor.seen_by(0).num_gun_ammo == 15
    assert not competitor.seen_by(0).is_fire


def test_the_time_ends_it(competitor: Competitor) -> None:
    competitor.begin(gathering(timeout=2))
    assert competitor.act(times=100).time_step == 100
    assert competitor.is_over


@pytest.mark.parametrize("agents", [1, 3])
def test_any_number_of_agents_gather(competitor: Competitor, agents: int) -> None:
    competitor.begin(gathering(agents=[setup(agent) for agent in range(agents)]))
    assert [one.id for one in competitor.latest.agent_obs_list] == list(range(agents))
    lists = [list(one.supply_info_list) for one in competitor.latest.agent_obs_list]
    assert lists == [lists[0]] * agents
