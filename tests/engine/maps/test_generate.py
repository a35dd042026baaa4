"""Whole maps: they have what the config asks for, and one seed gives one map."""

import pytest

from wildscav_engine.maps import MapError, generate_map
from wildscav_engine.specs.map_spec import MapConfig, Placement

SMALL = MapConfig(size=60, houses=3, storeys=(1, 3), water=0.15, vegetation=0.6)


def test_one_seed_is_one_map() -> None:
    assert generate_map(SMALL, 3).digest == generate_map(SMALL, 3).digest


def test_the_greatest_seed_makes_a_map() -> None:
    assert generate_map(SMALL, 2**64 - 1).digest != generate_map(SMALL, 2**63 - 1).digest


@pytest.mark.parametrize("density", ["low", "high"])
def test_more_houses_than_fit_are_refused_with_what_is_possible(density: str) -> None:
    config = MapConfig(size=40, houses=50, density=density)

    with pytest.raises(MapError, match=r"^houses is 50: a map of 40 m .* has room for 0 to [0-9]$"):
        generate_map(config, 0)


def test_as_many_houses_as_were_said_to_fit_do_fit() -> None:
    with pytest.raises(MapError) as refused:
        generate_map(MapConfig(size=50, houses=50), 0)
    room = int(str(refused.value).split()[-1])

    assert len(generate_map(MapConfig(size=50, houses=room), 0).houses) == room


def test_a_map_without_open_ground_is_refused() -> None:
    # One block covers everything: bodies can stand on it, but nowhere on the ground.
    block = Placement(kind="block", location=(0.0, 0.0), area=(40.0, 40.0), height=30.0)
    config = MapConfig(size=40, houses=0, water=0.0, placements=(block,))

    with pytest.raises(MapError, match=r"^seed 3 leaves no open, dry ground to stand on in a map of 40 m "):
        generate_map(config, 3)
