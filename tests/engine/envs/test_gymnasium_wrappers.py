"""Gymnasium's own wrappers take the environments as they are."""

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.wrappers import (
    NormalizeObservation,
    RecordEpisodeStatistics,
    RecordVideo,
    TimeAwareObservation,
)
from gymnasium.wrappers import vector as of_vectors
from tests.engine.envs.common import env_id, options

from wildscav_engine.envs import aec_env, parallel_env

STEPS = 5  # of an episode
CHOSEN: dict[str, Any] = options("navigation", sensors={}, action_mode="multidiscrete", time_limit=STEPS / 10)


def vector(mode: str, **more: Any) -> Any:
    made: dict[str, Any] = {"num_envs": 2, "vectorization_mode": "vector_entry_point", "autoreset_mode": mode}
    return gymnasium.make_vec(env_id("navigation"), **made, **CHOSEN, rewards={"step": 1.0}, **more)


def single(**more: Any) -> Any:
    return gymnasium.make(env_id("navigation"), **CHOSEN, rewards={"step": 1.0}, **more)


def test_statistics_of_a_single_environment() -> None:
    env = RecordEpisodeStatistics(single())
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


@pytest.mark.parametrize("flat", [False, True])
def test_the_number_of_steps_is_observed_if_it_is_given_where_an_environment_is_made(flat: bool) -> None:
    limited = single(flat=flat, max_episode_steps=STEPS)
    assert limited.spec.max_episode_steps == limited.unwrapped.arena.template.step_limit
    env = TimeAwareObservation(limited, flatten=False, dict_time_key="steps")
    env.reset(seed=1)
    told = []
    for _ in range(STEPS):
        seen, _, _, truncated, _ = env.step(env.action_space.sample())
        told.append((int(seen["time" if flat else "steps"][0]), truncated))
    assert told == [(step, step == STEPS) for step in range(1, STEPS + 1)]


# Gymnasium normalizes no Dict, and of vectors none that begin anew in the same step.
def test_flat_observations_are_normalized() -> None:
    envs = of_vectors.NormalizeObservation(vector("NextStep", flat=True))
    for each in (NormalizeObservation(single(flat=True)), envs):
        each.reset(seed=1)
        for _ in range(STEPS):
            seen = each.step(each.action_space.sample())[0]
        assert seen.shape == each.observation_space.shape
        # n numbers deviate by at most sqrt(n) from their mean.
        assert 0.0 < np.abs(seen).max() <= np.sqrt(4.0 * STEPS)


@pytest.mark.parametrize(("frames", "rate"), [(1, 50.0), (5, 10.0), (15, 50.0 / 15.0)])
def test_a_video_takes_as_long_as_its_match(frames: int, rate: float) -> None:
    chosen: dict[str, Any] = {**CHOSEN, "frames_per_action": frames}
    several = parallel_env("navigation", **chosen), aec_env("navigation", **chosen)
    one = gymnasium.make(env_id("navigation"), **chosen)
    for env in (one, vector("NextStep", frames_per_action=frames), *several):
        assert env.metadata["render_fps"] == rate


@pytest.mark.slow
def test_videos(tmp_path: Path) -> None:
    pytest.importorskip("moviepy")
    picture = {"render_mode": "rgb_array", "render_view": "behind", "render_size": (32, 32)}
    quiet: dict[str, Any] = {"disable_logger": True}
    one = RecordVideo(single(**picture), str(tmp_path / "one"), **quiet)
    many = of_vectors.RecordVideo(
        vector("NextStep", **picture), str(tmp_path / "many"), video_aspect_ratio=(1, 1), **quiet
    )
    for env in (one, many):
        env.reset(seed=1)
        for _ in range(STEPS + 1 if env is many else STEPS):
            env.step(env.action_space.sample())
        env.close()
    films = [film.parent.name for film in tmp_path.glob("*/*.mp4") if film.stat().st_size > 0]
    assert set(films) == {"one", "many"}
