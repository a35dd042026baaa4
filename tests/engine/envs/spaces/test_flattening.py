"""Flat environments: the same episodes, told in rows of numbers."""

from typing import Any

import numpy as np
import pytest
from tests.engine.envs.common import OPEN

from wildscav_engine.envs import FlatObservations, SingleEnv, VectorArena, parallel_env
from wildscav_engine.envs.spaces.columns import EVENTS

SENSORS: dict[str, Any] = {"depth": {"width": 3, "height": 2}}
SHORT: dict[str, Any] = {"map": OPEN, "time_limit": 0.5, "sensors": SENSORS, "action_mode": "box"}
STEPS = 5  # half a second


def test_a_row_holds_what_the_wrapper_makes_of_the_dict() -> None:
    flat = SingleEnv("navigation", flat=True, **SHORT)
    wrapped = FlatObservations(SingleEnv("navigation", **SHORT))
    assert flat.observation_space == wrapped.observation_space
    assert flat.observation_space.shape == (3 + 3 + 6 + 3 + 2 + 8 + 9 + 3 * 2,)
    np.testing.assert_array_equal(flat.reset(seed=3)[0], wrapped.reset(seed=3)[0])
    action = np.array([1.0, 0.5, 0.1, 0.0, 1.0], np.float32)
    for _ in range(STEPS):
        (row, reward, *ends, told), (same, paid, *ended, named) = flat.step(action), wrapped.step(action)
        np.testing.assert_array_equal(row, same)
        assert (reward, ends) == (paid, ended)
        for name in ("events", "reward_terms", "metrics"):
            assert told[name].tolist() == pytest.approx(list(named[name].values())), name
    assert ends == [False, True]


def test_rows_of_a_vector_are_those_of_single_environments() -> None:
    vector = VectorArena("navigation", 2, autoreset_mode="SameStep", flat=True, **SHORT)
    singles = [SingleEnv("navigation", flat=True, **SHORT) for _ in range(2)]
    rows, _ = vector.reset(seed=8)
    np.testing.assert_array_equal(rows, [env.reset(seed=8 + row)[0] for row, env in enumerate(singles)])
    actions = np.ones((2, 5), np.float32) * 0.7
    for _ in range(STEPS):
        rows, *_, infos = vector.step(actions)
        alone = [env.step(action) for env, action in zip(singles, actions, strict=True)]
        assert infos["events"].shape == (2, len(EVENTS))
    assert vector.observation_space.contains(rows)
    for row, (last, *_, told) in enumerate(alone):
        np.testing.assert_array_equal(infos["final_obs"][row], last)
        for name in ("events", "reward_terms", "metrics"):
            np.testing.assert_array_equal(infos["final_info"][name][row], told[name])
        np.testing.assert_array_equal(rows[row], singles[row].reset()[0])
    assert not infos["metrics"].any()  # of the matches that have just begun


@pytest.mark.parametrize(
    ("mode", "mask"), [("dict", None), ("box", None), ("baseline", 48), ("multidiscrete", 27)]
)
def test_action_masks_of_several_are_rows_too(mode: str, mask: int | None) -> None:
    env = parallel_env("gathering", agents=2, flat=True, **(SHORT | {"action_mode": mode}))
    observations, infos = env.reset(seed=1)
    assert env.observation_space("agent_1").contains(observations["agent_1"])
    assert np.shape(infos["agent_1"].get("action_mask")) == (() if mask is None else (mask,))


def test_a_dict_of_actions_may_hold_arrays_of_one_number() -> None:
    """As TorchRL and RLlib give them."""
    env = SingleEnv("navigation", **(SHORT | {"action_mode": "dict"}))
    env.action_space.seed(0)
    action = env.action_space.sample()
    told = []
    for chosen in (action, {name: np.array([value]) for name, value in action.items()}):
        env.reset(seed=1)
        told.append(env.step(chosen)[0]["position"].tolist())
    assert told[0] == told[1]
