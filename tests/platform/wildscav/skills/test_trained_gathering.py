"""What a trained policy is shown by an agent that remembers for it: by a real policy, of a baseline."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.platform.wildscav.skills.observations import match_info, seen

from wildscav import Action, Observation, SupplyBox
from wildscav.baselines import baseline_folder
from wildscav.skills.trained_gathering import GatheringPolicyAgent

BOX = SupplyBox(id=3, position=(0.0, 3.0, 4.0), quantity=10)
SECONDS = 5


class Commando(GatheringPolicyAgent):
    """The baseline, whose policy notes what it is shown."""

    folder = baseline_folder("learned-commando")

    def __init__(self) -> None:
        super().__init__()
        self.shown: list[Observation] = []
        act = self.policy.act

        def noted(observation: Observation) -> Action:
            self.shown.append(observation)
            return act(observation)

        self.policy.act = noted  # type: ignore[method-assign]


@pytest.fixture
def agent() -> Commando:
    commando = Commando()
    commando.reset(match_info(time_limit=180.0))
    return commando


def sight(agent: Commando, step: int, hot_spot: float = 0.0) -> Observation:
    """What the agent sees that stands under a box, on a storey above it."""
    tensors = {
        name: np.zeros(shape, np.float32)
        for name, shape in agent.policy.environment.observer.shapes.items()
        if name in ("lidar", "nearby_supplies", "sights", "to_hot_spot", "to_supplies")
    }
    tensors["to_hot_spot"][0] = hot_spot
    return seen(step=step, frame=5 * step, time=step / 10, supply_boxes=(BOX,), tensors=tensors)


def test_a_box_out_of_reach_vanishes_from_all_that_the_policy_sees(agent: Commando) -> None:
    for step in range(10 * SECONDS):
        assert isinstance(agent.act(sight(agent, step, hot_spot=1.0)), Action)
    first, last = agent.shown[0], agent.shown[-1]
    assert first.supply_boxes == (BOX,)
    assert first.tensors["nearby_supplies"][0].tolist() == [1, 10, 0, 3, 4, 5]
    assert first.tensors["to_supplies"][0] == pytest.approx([1, 0, 1, 3, math.log(5), math.log(11)])
    assert last.supply_boxes == ()
    assert not last.tensors["nearby_supplies"].any()
    assert not last.tensors["to_supplies"].any()


def test_without_a_hot_spot_a_place_of_the_search_stands_in_for_it(agent: Commando) -> None:
    there = agent.search.next_place(seen())
    agent.reset(match_info(time_limit=180.0))
    agent.act(replace(sight(agent, 0), position=(there[0], 0.0, there[2] - 50.0)))
    agent.act(sight(agent, 1, hot_spot=1.0))
    without, with_one = (observation.tensors["to_hot_spot"] for observation in agent.shown)
    assert without[0] == 1.0
    assert math.hypot(without[1], without[2]) == pytest.approx(1.0)
    assert with_one.tolist() == [1.0, *[0.0] * 8]
