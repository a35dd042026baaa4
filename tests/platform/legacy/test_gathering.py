"""Supply gathering by the original's contract: where boxes lie, what is in them, who takes them."""

from typing import Any

from tests.platform.legacy.helpers.commands import command
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
