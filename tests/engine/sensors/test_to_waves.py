"""The ways to the waves of supplies: in a match by hand, and as its agents are told of them."""

import math

import numpy as np
import pytest
from tests.builders import make_match, place

from wildscav_engine.sensors import ToWaves
from wildscav_engine.specs.supply_config import HotSpot, SupplyConfig, SupplyWave

# Seen from (1, -1) with a yaw of 90°, the first centre is 4 m to the right and 3 m ahead; the second is
# 8 m to the left and 6 m behind.
TWICE = SupplyConfig(
    waves=(SupplyWave(time=2.0, center=(4.0, -5.0)), SupplyWave(time=7.0, center=(-5.0, 7.0)))
)
FIRST = (1.0, 0.8, 0.6, math.log(6.0))
SECOND = (1.0, -0.8, -0.6, math.log(11.0))
NONE = (0.0,) * 4


@pytest.mark.parametrize(
    ("frame", "reading"),
    [
        (0, (*NONE, *FIRST, 2.0)),  # none has appeared yet: the first one is told
        (99, (*NONE, *FIRST, 0.02)),
        (100, (*FIRST, *SECOND, 5.0)),  # it appears in this frame
        (350, (*SECOND, *NONE, 0.0)),  # the last one
        (9000, (*SECOND, *NONE, 0.0)),
    ],
)
def test_it_reads_the_ways_to_the_latest_wave_and_to_the_next(frame: int, reading: tuple[float, ...]) -> None:
    match = make_match("battle", supplies=TWICE)
    match.state.matches.frame[0] = frame
    place(match, 0, (1, 0.5, -1), 90)
    assert ToWaves().read(match, [0])[0] == pytest.approx(reading, abs=1e-5)


def test_places_of_the_hot_spot_are_waves_as_agents_are_told() -> None:
    moving = HotSpot(start=1.0, interval=2.0, places=2, boxes=1)
    match = make_match("battle", supplies=SupplyConfig(waves=TWICE.waves, hot_spot=moving))
    told = match.start_info(0).waves
    assert [wave.time for wave in told] == [1.0, 2.0, 3.0, 7.0]
    place(match, 0, (told[2].center[0], 0.0, told[2].center[1] - 5.0), 0)
    match.state.matches.frame[0] = 150
    assert ToWaves().read(match, [0])[0][:4] == pytest.approx((1, 0, 1, math.log(6)), abs=1e-5)


def test_a_wave_at_ones_feet_has_no_direction() -> None:
    here = SupplyConfig(waves=(SupplyWave(center=(1.0, -1.0)),))
    match = make_match("gathering", supplies=here)
    place(match, 0, (1, 0.5, -1), 30)
    assert ToWaves().read(match, [0])[0].tolist() == [1.0, *[0.0] * 8]


def test_waves_at_a_random_place_are_those_that_agents_are_told_of() -> None:
    match = make_match("battle", supplies=SupplyConfig(waves=(SupplyWave(center=None),)))
    (wave,) = match.start_info(0).waves
    x, _, z = match.state.agents.position[0, 0]
    _, right, ahead, distance = ToWaves().read(match, [0])[0][:4]
    assert distance == pytest.approx(math.log(1 + math.hypot(wave.center[0] - x, wave.center[1] - z)), 1e-5)
    assert math.hypot(right, ahead) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("track", ["navigation", "capture"])
def test_all_is_zero_where_nobody_gathers(track: str) -> None:
    assert not np.any(ToWaves().read(make_match(track), [0]))
