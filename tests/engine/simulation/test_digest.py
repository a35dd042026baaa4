"""The digest of a match notices every change of what its agents and boxes are."""

from collections.abc import Callable

import numpy as np
import pytest
from tests.builders import act, lay_boxes, make_match

from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.state import EQUIPMENT, Agents
from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave

RICH = SupplyConfig(waves=(SupplyWave(center=(0, 0), radius=1000, outdoor_richness=50),), spacing=2)
# What a match is set up with and never changes, what says nothing, and what a frame sets anew or clears.
FIXED = {"start", *EQUIPMENT, "present", "team", "robot", "memory", "turns", "next_in_square", "near"}
PLAYED_ANEW = {"damage", "walk_velocity", "on_ground", "fired", "hit_seat", "hit_by_seat", "gained", "health"}
PLAYED_ANEW |= {"reached", "shot_end", "velocity", "in_water"}


def digest_after(change: Callable[[Match], object]) -> int:
    match = make_match("battle", seats=3, supplies=RICH)
    change(match)
    act(match, 1)
    return match.digest


@pytest.fixture(scope="module")
def unchanged() -> int:
    return digest_after(lambda match: None)


@pytest.mark.parametrize("field", sorted(set(Agents._fields) - FIXED - PLAYED_ANEW))
def test_every_fact_of_an_agent_is_in_it(field: str, unchanged: int) -> None:
    def change(match: Match) -> None:
        array = getattr(match.state.agents, field)[0]
        array[1] = array[1] + (7 if array.dtype != np.bool_ else True)

    assert digest_after(change) != unchanged


@pytest.mark.parametrize("field", ["WALK_SPEED", "turn", "look", "shoot", "reload", "pick_up", "jump"])
def test_every_action_is_in_it(field: str, unchanged: int) -> None:
    match = make_match("battle", seats=3, supplies=RICH)
    act(match, 1, seat_2={field.upper(): 1})
    assert match.digest != unchanged


def test_which_seat_a_fact_is_of_is_in_it() -> None:
    one, other = (digest_after(lambda match, seat=seat: carry(match, seat)) for seat in (0, 2))
    assert one != other


def carry(match: Match, seat: int) -> None:
    match.state.agents.position[0] = match.state.agents.position[0, 0]
    match.state.agents.supplies[0, seat] = 5


def test_boxes_laid_taken_and_dropped_are_in_it() -> None:
    start = {make_match("gathering", seed=seed, supplies=RICH).digest - seed for seed in (1, 2)}
    assert len(start) == 2
    digests = set()
    for quantity in (3, 4):
        match = make_match("gathering", supplies=RICH)
        lay_boxes(match, match.state.agents.position[0, 0], quantity=quantity)
        act(match, 1, seat_0={"pick_up": 1})
        match.state.agents.supplies[0], match.state.agents.gained[0] = 0, 0
        digests.add(match.digest)
    assert len(digests) == 2
