"""Maps as a whole: what a config asks for is there, and one seed is one map."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

from wildscav_engine.geometry.shapes import box, pose
from wildscav_engine.geometry.world import Kind, build_world
from wildscav_engine.maps import MapError, generate, generate_map, map_of
from wildscav_engine.spec import MapConfig, MapSpec

SMALL = MapConfig(size=60, houses=3, storeys=(1, 3), water=0.15, vegetation=0.6)
STREET = MapConfig(size=80, houses=6, density="high")

DIGESTS = """
import json
from wildscav_engine.maps import generate_map
from wildscav_engine.spec import MapConfig
for config in {configs}:
    print(generate_map(MapConfig.model_validate(config), 7).digest)
"""


def test_one_seed_is_one_map() -> None:
    assert generate_map(SMALL, 3).digest == generate_map(SMALL, 3).digest


def test_other_seeds_are_other_maps() -> None:
    maps = [generate_map(SMALL, seed) for seed in range(6)]

    assert len({game_map.houses for game_map in maps}) == 6
    assert len({game_map.world.heights.tobytes() for game_map in maps}) == 6
    assert len({len(game_map.world.solid_kind) for game_map in maps}) > 3


def test_the_greatest_seed_makes_a_map() -> None:
    assert generate_map(SMALL, 2**64 - 1).digest != generate_map(SMALL, 2**63 - 1).digest


OTHER_MACHINES = {
    "numba without newer instructions": {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
    "numpy without newer instructions": {
        "NPY_DISABLE_CPU_FEATURES": " ".join(name for name in __cpu_dispatch__ if __cpu_features__[name])
    },
}


@pytest.mark.parametrize("machine", OTHER_MACHINES)
def test_every_machine_makes_the_same_bytes(machine: str) -> None:
    configs = [config.model_dump() for config in (SMALL, STREET)]
    run = subprocess.run(
        [sys.executable, "-c", DIGESTS.format(configs=json.dumps(configs))],
        env=os.environ | OTHER_MACHINES[machine],
        capture_output=True,
        text=True,
        check=True,
    )

    assert run.stdout.split() == [generate_map(config, 7).digest for config in (SMALL, STREET)]


def test_a_map_is_centred_on_the_origin() -> None:
    world = generate_map(SMALL, 0).world

    assert world.corner.tolist() == [-30.0, -30.0]
    assert world.heights.shape == (31, 31)
    assert world.water.shape == (30, 30)


def test_agents_start_outdoors() -> None:
    game_map = generate_map(SMALL, 0)

    assert game_map.world.spawns is game_map.outdoor


def test_the_same_spec_gives_the_same_object() -> None:
    spec = MapSpec(config=SMALL, seed=1)

    assert map_of(spec) is map_of(spec.model_copy())
    assert map_of(spec).spec == spec


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
    # One block over everything: nobody can stand anywhere.
    block = box(Kind.ROCK, pose(0.0, 0.0, 0.0), (-30.0, -1.0, -30.0), (30.0, 9.0, 30.0))
    flat, dry = np.zeros((21, 21)), np.full((20, 20), -np.inf)
    world = build_world((-20.0, -20.0), flat, dry, [block], np.zeros((0, 3)))

    with pytest.raises(MapError, match="leaves no open ground"):
        generate._places(world, MapSpec(), [], [])
