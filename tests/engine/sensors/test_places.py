"""Where agents are told that places are: the target, the hot spot, waves of supplies, and the safe zone."""

import math
from typing import Any

import numpy as np
import pytest
from tests.builders import flat_world, make_match, place
from tests.engine.envs.common import OPEN

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.sensors import (
    Compass,
    HotSpotSensor,
    SafeZone,
    Sensor,
    Teammates,
    ToHotSpot,
    ToWaves,
)
from wildscav_engine.specs.supply_config import HotSpot, SupplyConfig, SupplyWave
from wildscav_engine.specs.zone_config import ZoneConfig, ZonePhase

HALF = 0.7071067811865476


@pytest.mark.parametrize(
    ("sensor", "track", "seats"),
    [
        *((Compass(), track, 1) for track in ("gathering", "battle")),
        *((HotSpotSensor(), track, 1) for track in ("navigation", "gathering", "battle", "royale")),
        (ToHotSpot(), "battle", 1),
        *((ToWaves(), track, 1) for track in ("navigation", "capture")),
        (SafeZone(), "battle", 1),
        (Teammates(), "battle", 3),  # each in a team of its own
    ],
)
def test_all_is_zero_where_there_is_no_such_thing(sensor: Sensor, track: str, seats: int) -> None:
    assert not sensor.read(make_match(track, seats=seats), range(seats)).any()


@pytest.mark.parametrize(
    ("target", "yaw", "reading"),
    [
        ((1, 0.5, 8), 0, (1, 0, 1, 10, 0)),  # straight ahead
        ((11, 0.5, -2), 0, (1, 1, 0, 10, 0)),  # to the right
        ((-9, 0.5, -2), 0, (1, -1, 0, 10, 0)),  # to the left
        ((1, 0.5, -12), 0, (1, 0, -1, 10, 0)),  # behind
        ((11, 0.5, -2), 90, (1, 0, 1, 10, 0)),  # who has turned to it has it ahead
        ((1, 0.5, 8), 135, (1, -HALF, -HALF, 10, 0)),
        ((4, 3.5, 2), 0, (1, 0.6, 0.8, 5, 3)),  # the distance is level, the height beside it
        ((1, -6.5, -2), 0, (1, 0, 0, 0, -7)),  # right below
    ],
)
def test_the_compass_reads_flag_sine_cosine_distance_and_height(
    target: tuple[float, float, float], yaw: float, reading: tuple[float, ...]
) -> None:
    match = make_match("navigation")
    match.state.matches.target[0] = target
    place(match, 0, (1, 0.5, -2), yaw, pitch=30)
    assert Compass().read(match, [0])[0] == pytest.approx(reading, abs=1e-6)


# Seen from (1, -1) with a yaw of 90°, (4, -5) is 4 m to the right and 3 m ahead; (-5, 7) is 8 m to the left
# and 6 m behind.
PLACES = (100, 4, -5), (350, -5, 7)  # frame, x and z in m
NONE, FIRST, SECOND = (0.0,) * 4, (1, 3, -4, 5), (1, -6, 8, 10)
TO_FIRST, TO_SECOND = (1, 0.8, 0.6, math.log(6.0)), (1, -0.8, -0.6, math.log(11.0))


@pytest.mark.parametrize(
    ("frame", "latest", "following", "seconds"),
    [
        (0, None, 0, 2.0),  # it has not come yet: its first place is told
        (99, None, 0, 0.02),
        (100, 0, 1, 5.0),  # it comes in this frame
        (349, 0, 1, 0.02),
        (350, 1, None, 0.0),  # it stays at its last place
        (9000, 1, None, 0.0),
    ],
)
@pytest.mark.parametrize(
    ("sensor", "readings"),
    [
        (HotSpotSensor(), (FIRST, SECOND)),
        (ToHotSpot(), (TO_FIRST, TO_SECOND)),
        (ToWaves(), (TO_FIRST, TO_SECOND)),
    ],
)
def test_it_reads_the_latest_place_and_where_and_when_the_next_is(
    sensor: Sensor,
    readings: tuple[tuple[float, ...], ...],
    frame: int,
    latest: int | None,
    following: int | None,
    seconds: float,
) -> None:
    waves = tuple(SupplyWave(time=frame / 50, center=(x, z)) for frame, x, z in PLACES)
    spot = None if isinstance(sensor, ToWaves) else HotSpot(places=2, boxes=1)
    match = make_match("battle", supplies=SupplyConfig(waves=waves, hot_spot=spot))
    if spot:
        match.state.matches.hot_spots[0] = PLACES
    match.state.matches.frame[0] = frame
    place(match, 0, (1, 0.5, -1), 90)
    wanted = [*(NONE if one is None else readings[one] for one in (latest, following)), (seconds,)]
    assert sensor.read(match, [0])[0] == pytest.approx(sum(wanted, ()), abs=1e-5)


def test_places_of_the_hot_spot_are_waves_as_agents_are_told() -> None:
    moving = HotSpot(start=1.0, interval=2.0, places=2, boxes=1)
    waves = SupplyWave(time=2.0, center=(4.0, -5.0)), SupplyWave(time=7.0, center=(-5.0, 7.0))
    match = make_match("battle", supplies=SupplyConfig(waves=waves, hot_spot=moving))
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


SUPPLIES = SupplyConfig(waves=(), hot_spot=HotSpot(start=0.5, interval=1.0, places=3, boxes=2))
RICH_MAP = OPEN.config.model_copy(update={"supplies": SUPPLIES})


@pytest.mark.parametrize(
    ("track", "options", "is_told"),
    [
        ("battle", {"supplies": SUPPLIES}, True),
        ("gathering", {"supplies": SUPPLIES}, True),
        ("royale", {"map": RICH_MAP}, True),
        ("battle", {"map": OPEN.model_copy(update={"config": RICH_MAP})}, True),
        ("battle", {}, False),
        ("battle", {"supplies": SUPPLIES, "sensors": {}}, False),  # who names sensors gets those alone
        ("navigation", {"map": RICH_MAP}, False),  # nobody gathers there, whatever the map says
    ],
)
def test_an_environment_tells_of_the_hot_spot_where_there_is_one(
    track: str, options: dict[str, Any], is_told: bool
) -> None:
    assert ("hot_spot" in EnvConfig(track=track, **options).read_sensors()) == is_told


def test_the_zone_tells_how_far_inside_one_is_and_what_comes() -> None:
    phases = (
        ZonePhase(wait=2, shrink=4, share=0.5, damage=3),
        ZonePhase(wait=1, shrink=1, share=0, damage=9),
    )
    match = make_match("royale", world=flat_world(size=80), zone=ZoneConfig(phases=phases))
    place(match, 0, (10, 0, 0))
    row = match.state.matches.zone[0, 0]
    radius = 40 * np.sqrt(2)
    reading = SafeZone().read(match, [0])[0]
    wanted = [1, radius - 10, -10, 0, radius, row[5] - 10, row[6], radius / 2, 2, 6, 3]
    np.testing.assert_allclose(reading, wanted, rtol=1e-6)
    match.state.matches.frame[0] = 6 * 50
    reading = SafeZone().read(match, [0])[0]
    np.testing.assert_allclose(reading[[4, 7, 8, 9, 10]], [radius / 2, 0, 1, 2, 9], rtol=1e-6)
    match.state.matches.frame[0] = 60 * 50
    reading = SafeZone().read(match, [0])[0]
    assert reading[[4, 7, 8, 9]].tolist() == [0, 0, 0, 0]
    assert reading[[2, 3]].tolist() == reading[[5, 6]].tolist()
