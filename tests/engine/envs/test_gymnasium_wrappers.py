"""Gymnasium's own wrappers take the environments as they are."""

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.wrappers import (
    FrameStackObservation,
    NormalizeObservation,
    RecordEpisodeStatistics,
    RecordVideo,
    TimeAwareObservation,
    TransformReward,
)
from gymnasium.wrappers import vector as of_vectors
from tests.engine.envs.common import env_id, options

from wildscav_engine.envs import aec_env, parallel_env

STEPS = 5  # of an episode
CHOSEN: dict[str, Any] = options("navigation", sensors={}, action_mode="multidiscrete", time_limit=STEPS / 10)


def vector(mode: str, **more: Any) -> Any:
    made: dict[str, Any] = {"num_envs": 2, "vectorization_mode": "vector_entry_point", "autoreset_mode": mode}
    return gymnasium.make_vec(env_id("navigation"), **made, **CHOSEN, rewards={"step": 1.0}, **more)


def test_statistics_of_a_single_environment() -> None:
    env = RecordEpisodeStatistics(gymnasium.make(env_id("navigation"), **CHOSEN, rewards={"step": 1.0}))
    env.reset(seed=1)
    for _ in range(STEPS):
        *_, info = env.step(env.action_space.sample())
    assert (info["episode"]["r"], info["episode"]["l"]) == (STEPS, STEPS)


# In the next-step mode, a step in which an environment is reset belongs to no episode.
@pytest.mark.parametrize(("mode", "ends"), [("SameStep", [5, 10]), ("NextStep", [5, 11])])
def test_statistics_of_a_vector(mode: str, ends: list[int]) -> None:
    envs = of_vectors.RecordEpisodeStatistics(vector(mode))
    envs.reset(seed=1)
    told = []
    for step in range(1, 12):
        *_, infos = envs.step(envs.action_space.sample())
        if "episode" in infos:
            told.append(step)
            assert infos["episode"]["r"].tolist() == infos["episode"]["l"].tolist() == [STEPS, STEPS]
    assert told == ends


def single(flat: bool, **more: Any) -> Any:
    return gymnasium.make(env_id("navigation"), **CHOSEN, rewards={"step": 1.0}, flat=flat, **more)


@pytest.mark.parametrize("flat", [False, True])
def test_rewards_are_transformed_and_observations_stacked(flat: bool) -> None:
    env = FrameStackObservation(TransformReward(single(flat), lambda reward: 3.0 * float(reward)), 2)
    stacked, _ = env.reset(seed=1)
    assert env.observation_space.contains(stacked)
    before = stacked if flat else stacked["position"]
    stacked, reward, *_ = env.step(np.array([1, 1, 3, 2, 0]))
    now = stacked if flat else stacked["position"]
    assert reward == 3.0
    np.testing.assert_array_equal(now[0], before[1])
    assert (now[0] != now[1]).any()


@pytest.mark.parametrize("flat", [False, True])
def test_the_number_of_steps_is_observed_if_it_is_given_where_an_environment_is_made(flat: bool) -> None:
    limited = single(flat, max_episode_steps=STEPS)
    assert limited.spec.max_episode_steps == limited.unwrapped.arena.template.step_limit
    env = TimeAwareObservation(limited, flatten=False, dict_time_key="steps")
    env.reset(seed=1)
    told = []
    for _ in range(STEPS):
        seen, _, _, truncated, _ = env.step(env.action_space.sample())
        told.append((int(seen["time" if flat else "steps"][0]), truncated))
    assert told == [(step, step == STEPS) for step in range(1, STEPS + 1)]


@pytest.mark.parametrize("flat", [False, True])
@pytest.mark.parametrize("mode", ["SameStep", "NextStep"])
def test_rewards_of_a_vector_are_transformed_and_normalized(mode: str, flat: bool) -> None:
    envs = of_vectors.TransformReward(vector(mode, flat=flat), lambda rewards: 3.0 * rewards)
    envs.reset(seed=1)
    assert envs.step(envs.action_space.sample())[1].tolist() == [3.0, 3.0]
    normalized = of_vectors.NormalizeReward(vector(mode, flat=flat))
    normalized.reset(seed=1)
    assert np.isfinite(normalized.step(envs.action_space.sample())[1]).all()


# Gymnasium normalizes no Dict, and of vectors none that begin anew in the same step.
def test_flat_observations_are_normalized() -> None:
    env, envs = (
        NormalizeObservation(single(flat=True)),
        of_vectors.NormalizeObservation(vector("NextStep", flat=True)),
    )
    for each in (env, envs):
        each.reset(seed=1)
        for _ in range(STEPS):
            seen = each.step(each.action_space.sample())[0]
        assert seen.shape == each.observation_space.shape
        assert (
            0.0 < np.abs(seen).max() <= np.sqrt(4.0 * STEPS)
        )  # n numbers deviate by at most sqrt(n) from their mean


@pytest.mark.parametrize(("frames", "rate"), [(1, 50.0), (5, 10.0), (15, 50.0 / 15.0)])
def test_a_video_takes_as_long_as_its_match(frames: int, rate: float) -> None:
    chosen: dict[str, Any] = {**CHOSEN, "frames_per_action": frames}
    single = gymnasium.make(env_id("navigation"), **chosen)
    several = parallel_env("navigation", **chosen), aec_env("navigation", **chosen)
    for env in (single, vector("NextStep", frames_per_action=frames), *several):
        assert env.metadata["render_fps"] == rate


@pytest.mark.slow
@pytest.mark.parametrize("view", ["eyes", "behind", "top"])
def test_videos(tmp_path: Path, view: str) -> None:
    pytest.importorskip("moviepy")
    picture = {"render_mode": "rgb_array", "render_view": view, "render_size": (32, 32)}
    env = RecordVideo(
        gymnasium.make(env_id("navigation"), **CHOSEN, **picture), str(tmp_path / "one"), disable_logger=True
    )
    env.reset(seed=1)
    for _ in range(STEPS):
        env.step(env.action_space.sample())
    env.close()
    envs = of_vectors.RecordVideo(
        vector("NextStep", **picture), str(tmp_path / "many"), video_aspect_ratio=(1, 1), disable_logger=True
    )
    envs.reset(seed=1)
    for _ in range(STEPS + 1):
        envs.step(np.tile(np.array([1, 1, 3, 2, 0]), (2, 1)))
    envs.close()
    for folder in ("one", "many"):
        films = list((tmp_path / folder).glob("*.mp4"))
        assert films, folder
        assert all(film.stat().st_size > 0 for film in films)
