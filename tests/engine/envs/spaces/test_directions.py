"""Observations of version 1: the way to the target, to the nearest box and to the nearest enemy."""

from typing import Any, Literal

import gymnasium
import numpy as np
import pytest
from tests.engine.envs.common import OPEN, TRACK_NAMES, digest, options

from wildscav_engine.envs import SingleEnv
from wildscav_engine.envs.registry import env_id

WAYS = {
    "navigation": {"to_target"},
    "gathering": {"to_box"},
    "capture": {"to_target"},
    "battle": {"to_box", "to_enemy"},
    "royale": {"to_box", "to_enemy"},
}

# Gymnasium says so of every id but the newest.
OLD = pytest.mark.filterwarnings("ignore:.*is out of date:DeprecationWarning")


def made(track: str, version: Literal[0, 1], **more: Any) -> Any:
    env: Any = gymnasium.make(
        f"wildscav_engine:{env_id(track, version)}", **options(track, action_mode="multidiscrete", **more)
    )
    env.action_space.seed(3)
    return env


def played(env: Any) -> list[Any]:
    return [env.reset(seed=3)[0], *(env.step(env.action_space.sample()) for _ in range(8))]


@OLD
@pytest.mark.parametrize("track", TRACK_NAMES)
def test_version_0_is_version_1_without_the_ways(track: str) -> None:
    old, new = (made(track, version) for version in (0, 1))
    assert set(new.observation_space.spaces) - set(old.observation_space.spaces) == WAYS[track]
    for before, after in zip(played(old), played(new), strict=True):
        seen = after[0] if isinstance(after, tuple) else after
        assert new.observation_space.contains(seen)
        for way in WAYS[track]:
            del seen[way]
        assert digest(after) == digest(before)


# Policies that were trained on rows of version 0 go on playing.
@OLD
def test_flat_rows_of_version_0_stay_as_they_are() -> None:
    chosen = {"map": OPEN, "start": (0.0, 0.0, 0.0), "target": (3.0, 0.0, 4.0), "sensors": {}, "flat": True}
    row, _ = made("navigation", 0, **chosen).reset(seed=1)
    body, position, velocity = [1, 1, 0], [0, 0, 0], [0, 0, 0]
    target, time = [1, 0.03, 0, 0.04, 0.03, 0, 0.04, 0.05], [0.015, 0]
    view = [0, 0, 0, 0.1, 0, 0.1]  # degrees over 180; sines and cosines over 10
    assert row.tolist() == pytest.approx([*body, *position, *target, *time, *velocity, *view], abs=1e-4)


@pytest.mark.parametrize(
    ("turns", "right", "ahead"),
    [
        (0, 0.6, 0.8),  # facing north
        (2, -0.8, 0.6),  # facing east, the north is to the left
    ],
)
def test_the_way_to_the_target(turns: int, right: float, ahead: float) -> None:
    chosen = options("navigation", sensors={}, version=1, action_mode="box", map=OPEN)
    env = SingleEnv("navigation", **chosen, start=(0.0, 0.0, 0.0), target=(9.0, 0.0, 12.0))
    observation, _ = env.reset(seed=1)
    for _ in range(turns):
        observation, *_ = env.step(np.array([0.0, 0.0, 1.0, 0.0, 0.0], np.float32))  # 45° right
    known, *world, to_right, to_ahead, above, nearness, logarithm = observation["to_target"].tolist()
    assert known == 1
    assert world == pytest.approx([0.6, 0.0, 0.8], abs=1e-3)  # the lawn is not quite level
    assert (to_right, to_ahead) == pytest.approx((right, ahead), abs=1e-5)
    assert above == pytest.approx(0.0, abs=1e-3)
    assert (nearness, logarithm) == pytest.approx((np.exp(-3.0), np.log(16.0)))


def test_what_is_above_the_view_after_looking_down() -> None:
    chosen = options("navigation", sensors={}, version=1, action_mode="box", map=OPEN)
    env = SingleEnv("navigation", **chosen, start=(0.0, 0.0, 0.0), target=(0.0, 0.0, 12.0))
    env.reset(seed=1)
    observation, *_ = env.step(np.array([0.0, 0.0, 0.0, 1.0, 0.0], np.float32))  # 20° down
    assert observation["to_target"][6] == pytest.approx(np.sin(np.radians(20.0)), abs=1e-3)
    assert observation["to_target"][5] == pytest.approx(1.0)  # the pitch does not matter for walking


@pytest.mark.parametrize(
    ("teammates", "spots", "told"),
    [
        (0, (-15.0,), [0.0, 0.0, 0.0]),  # it stands behind the learner's back
        (0, (15.0,), [1.0, 1.0, np.log(16.0)]),
        (1, (6.0, 15.0), [1.0, 1.0, np.log(16.0)]),  # nobody on one's own team is an enemy
    ],
)
def test_the_way_to_the_nearest_enemy_in_sight(
    teammates: int, spots: tuple[float, ...], told: list[float]
) -> None:
    starts = tuple((0.0, 0.0, z) for z in (0.0, *spots))
    chosen = options("battle", sensors={}, version=1, map=OPEN, starts=starts)
    chosen |= {"teammates": ("walker",) * teammates, "opponents": ("walker",)}
    observation, _ = SingleEnv("battle", **chosen).reset(seed=1)
    assert observation["to_enemy"][[0, 5, 8]].tolist() == pytest.approx(told)
