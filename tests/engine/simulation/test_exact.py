"""Same spec and actions, same bits: at any thread count, batch size, process and processor."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from wildscav_engine.maps import MapError, generate_map, map_of
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.setup.match_setup import MatchSetupError
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec

CONFIGS = (MapConfig(size=60, houses=2, storeys=(1, 2)), MapConfig(size=80, houses=3, vegetation=0.9))
MAPS = (
    *CONFIGS,
    MapConfig(size=60, houses=3, storeys=(1, 3), water=0.15, vegetation=0.6),
    MapConfig(size=80, houses=6, density="high", relief=1.8, ruggedness=0.9),
)
SEATS = ("submission", "fighter", "gatherer", "fighter", "walker")
STEPS = 60


def specs(count: int) -> list[MatchSpec]:
    maps = [MapSpec(config=CONFIGS[index % 2], seed=index % 3) for index in range(count)]
    return [
        MatchSpec(track="battle", map=one, seed=index, seats=SEATS[: 3 + index % 3], time_limit=60)
        for index, one in enumerate(maps)
    ]


def actions(index: int, step: int) -> np.ndarray:
    """Some actions of the submission's seat, the same for the same match and step."""
    row = np.zeros((len(SEATS), 8), np.float32)
    row[0, :4] = (index * 37 + step * 11) % 360, (step * 7 + index) % 11, 3, 0.1
    row[0, 4:] = step % 9 == 0, 1, 1, step % 20 == 0
    return row


def digests_alone(count: int) -> list[int]:
    found = []
    for index, spec in enumerate(specs(count)):
        match = Match(spec)
        for step in range(STEPS):
            match.step(actions(index, step)[: match.seats])
        found.append(match.digest)
    return found


def digests_together(count: int, threads: int) -> list[int]:
    batch = Batch(specs(count))
    for step in range(STEPS):
        batch.step(np.array([actions(index, step) for index in range(count)]), threads=threads)
    return [int(digest) for digest in batch.state.matches.digest]


@pytest.fixture(scope="module")
def alone() -> list[int]:
    return digests_alone(64)


def test_a_batch_of_64_plays_as_64_batches_of_one(alone: list[int]) -> None:
    assert digests_together(64, threads=1) == alone
    assert len(set(alone)) == 64


@pytest.mark.parametrize("threads", [2, 5])
def test_several_threads_play_as_one(threads: int, alone: list[int], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wildscav_engine.simulation.batch.LEAST_AGENTS", 1)
    assert digests_together(64, threads=threads) == alone


def others() -> list[pytest.ParameterSet]:
    """Environments that make Numba or NumPy compute in other ways."""
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    has = " ".join(feature for feature in __cpu_dispatch__ if __cpu_features__.get(feature))
    return [
        pytest.param(
            {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
            id="a generic processor",
            marks=pytest.mark.slow,  # everything is compiled anew for it
        ),
        pytest.param({"NPY_DISABLE_CPU_FEATURES": has}, id="another process without AVX2 and AVX-512"),
    ]


@pytest.mark.parametrize("environment", others())
def test_other_processes_and_processors_play_the_same(alone: list[int], environment: dict[str, str]) -> None:
    code = (
        f"import {Path(__file__).stem} as t; from wildscav_engine.maps import generate_map\n"
        "print([generate_map(c, 5).digest for c in t.MAPS], t.digests_alone(4))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=Path(__file__).parent,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    maps = [generate_map(config, 5).digest for config in MAPS]
    assert done.stdout.strip() == f"{maps} {alone[:4]}"


def test_matches_that_differ_in_track_or_rules_cannot_share_a_batch() -> None:
    first, second = specs(2)
    with pytest.raises(MatchSetupError, match="same track"):
        Batch([first, second.model_copy(update={"track": "gathering"})])
    with pytest.raises(MatchSetupError, match="same frames_per_action"):
        Batch([first, second.model_copy(update={"frames_per_action": 3})])
    with pytest.raises(MatchSetupError, match="at least one"):
        Batch([])


def test_a_map_that_cannot_be_made_is_a_match_that_cannot_be_set_up() -> None:
    crowded = MapSpec(config=MapConfig(size=40, houses=50))
    with pytest.raises(MapError) as refused:
        map_of(crowded)
    with pytest.raises(MatchSetupError) as not_set_up:
        Batch([MatchSpec(track="battle", map=crowded)])
    assert str(not_set_up.value) == str(refused.value)
    assert str(refused.value).startswith("houses is 50")


@pytest.mark.parametrize(
    "rows",
    [
        np.zeros((2, 4, 8)),
        np.zeros((2, 6, 8)),
        np.zeros((1, 5, 8)),
        np.zeros(80),
        np.zeros((2, 5, 8), complex),
    ],
)
def test_actions_of_another_shape_are_refused_before_a_kernel_sees_them(rows: np.ndarray) -> None:
    batch = Batch([specs(3)[2]] * 2)
    with pytest.raises(ValueError, match=r"must be real numbers of shape \(2, 5, 8\)"):
        batch.step(rows)


def test_a_match_takes_lists_and_refuses_other_shapes() -> None:
    match = Match(specs(1)[0])
    match.step([[0.0] * 8] * 3)
    with pytest.raises(ValueError, match=r"must be real numbers of shape \(3, 8\)"):
        match.step(np.zeros((8, 3)))
    with pytest.raises(ValueError, match="there is no seat -1; the seats are 0 to 2"):
        match.start_info(-1)
