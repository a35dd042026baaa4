"""Wrappers that make one Box of what is observed and of what is done."""

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Box
from gymnasium.utils.env_checker import check_env
from tests.engine.envs.common import TRACK_NAMES, options

from wildscav_engine.envs import FlatActions, FlatObservations, SingleEnv
from wildscav_engine.envs.spaces.flattening import Flattener

SENSORS = {"depth": {"width": 4, "height": 3, "far": 50.0}, "teammates": {"limit": 1}}


@pytest.mark.filterwarnings("ignore:.*is different from the unwrapped version")
@pytest.mark.parametrize("track", TRACK_NAMES)
def test_flat_environments_pass_gymnasiums_own_test(track: str) -> None:
    env = FlatActions(FlatObservations(SingleEnv(track, **options(track, sensors=SENSORS))))  # type: ignore[arg-type]
    assert isinstance(env.observation_space, Box)
    assert isinstance(env.action_space, Box)
    check_env(env, skip_render_check=True)


@pytest.mark.parametrize("track", TRACK_NAMES)
def test_environments_are_flat_as_the_wrapper_makes_them(track: str) -> None:
    sensors = {**SENSORS, "segmentation": {"width": 4, "height": 3}, "compass": {}}
    made = options(track, sensors=sensors, action_mode="box", version=1)
    wrapped, flat = FlatObservations(SingleEnv(track, **made)), SingleEnv(track, **made, flat=True)  # type: ignore[arg-type]
    assert wrapped.observation_space == flat.observation_space
    np.testing.assert_array_equal(wrapped.reset(seed=1)[0], flat.reset(seed=1)[0])
    action = np.ones(flat.action_space.shape, np.float32)  # type: ignore[arg-type]
    np.testing.assert_array_equal(wrapped.step(action)[0], flat.step(action)[0])


def test_flat_numbers_are_those_of_the_dict_over_what_is_usual() -> None:
    env = SingleEnv("navigation", **options("navigation", sensors=SENSORS))
    observation, _ = env.reset(seed=1)
    flattener = Flattener(env.observation_space)  # type: ignore[arg-type]
    flat = flattener.flatten(observation)
    names = list(env.observation_space.spaces)  # type: ignore[attr-defined]
    start = sum(observation[name].size for name in names[: names.index("position")])
    assert flat[start : start + 3] == pytest.approx(observation["position"] / 100.0)
    start = sum(observation[name].size for name in names[: names.index("depth")])
    assert flat[start : start + 12] == pytest.approx(observation["depth"].reshape(-1) / 50.0)


def test_flat_actions_are_stretched_over_their_fields() -> None:
    env = FlatActions(SingleEnv("gathering", **options("gathering", sensors={})))
    names = list(env.env.action_space.spaces)  # type: ignore[attr-defined]
    low, middle, high = (env.action(np.full(len(names), value)) for value in (-1.0, 0.0, 1.0))
    assert (low["walk_direction"], middle["walk_direction"], high["walk_direction"]) == (0, 180, 360)
    assert (low["walk_speed"], middle["walk_speed"], high["walk_speed"]) == (0, 5, 10)
    assert (low["turn"], middle["turn"], high["turn"]) == (-180, 0, 180)
    assert (low["pick_up"], middle["pick_up"], high["pick_up"]) == (0, 1, 1)


@pytest.mark.parametrize(("wrapper", "mode"), [(FlatActions, "box"), (FlatActions, "baseline")])
def test_what_is_flat_already_is_refused(wrapper: type[gymnasium.Wrapper], mode: str) -> None:
    with pytest.raises(TypeError, match="must be a Dict"):
        wrapper(SingleEnv("navigation", **options("navigation", action_mode=mode)))
    with pytest.raises(TypeError, match="must be a Dict of Boxes"):
        FlatObservations(FlatObservations(SingleEnv("navigation", **options("navigation"))))  # type: ignore[arg-type]
