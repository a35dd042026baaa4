"""Readings of some boxes are those of the engine's sensors, bit for bit."""

from pathlib import Path

import numpy as np
import pytest
from tests.engine.envs.common import OPEN, options
from tests.platform.helpers.policy_matches import play_match

from wildscav import Action, Observation
from wildscav.skills.trained_gathering import with_boxes
from wildscav_engine.envs import SingleEnv
from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave

RICH = SupplyConfig(waves=(SupplyWave(center=(0.0, 0.0), outdoor_richness=20),), spacing=3)


@pytest.fixture
def played(tmp_path: Path) -> list[Observation]:
    """What an agent sees that walks in circles among many boxes, and picks some up."""
    env = SingleEnv("gathering", **options("gathering", map=OPEN, supplies=RICH, time_limit=6.0))
    env.reset(seed=3)
    assert env.arena.batch is not None
    found: list[Observation] = []

    def act(seen: Observation) -> Action:
        found.append(seen)
        return Action(walk_direction=seen.yaw, walk_speed=8.0, turn=2.0, pick_up=True)

    sensors = {"nearby_supplies": {"limit": 5}, "to_supplies": {"limit": 4}, "compass": {}}
    play_match(tmp_path, env.arena.batch.specs[0], sensors, lambda _: None, act)
    assert any(seen.gained for seen in found)
    return found


def test_with_all_boxes_they_are_what_the_sensors_read(played: list[Observation]) -> None:
    for seen in played:
        assert len(seen.supply_boxes) > 5
        readings = with_boxes(seen, seen.supply_boxes)
        for name, reading in seen.tensors.items():
            assert readings[name].dtype == reading.dtype
            assert readings[name].tobytes() == reading.tobytes(), name


def test_a_box_that_is_left_out_leaves_its_row_to_the_next(played: list[Observation]) -> None:
    seen = played[0]
    readings = with_boxes(seen, seen.supply_boxes[1:])
    assert np.array_equal(readings["nearby_supplies"][:4], seen.tensors["nearby_supplies"][1:])
    nothing = with_boxes(seen, ())
    assert not nothing["nearby_supplies"].any()
    assert not nothing["to_supplies"].any()
    assert nothing["compass"] is seen.tensors["compass"]


def test_sensors_that_were_not_asked_for_are_not_made_up(played: list[Observation]) -> None:
    from dataclasses import replace

    blind = replace(played[0], tensors={})
    assert with_boxes(blind, blind.supply_boxes) == {}
