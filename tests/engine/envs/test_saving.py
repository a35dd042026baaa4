"""States of environments: a fork, or a state put back, goes on bit for bit as the one it came from."""

from typing import Any

import numpy as np
import pytest
from tests.engine.envs.common import TRACK_NAMES, batch_of, digest, many_options, options

from wildscav_engine.envs import BatchedArena, SingleEnv, VectorArena, parallel_env
from wildscav_engine.simulation.snapshot import StateError


def some_steps(env: SingleEnv, seed: int) -> list[Any]:
    """Return what a few steps and the next episode tell."""
    env.action_space.seed(seed)
    told: list[Any] = [digest(env.step(env.action_space.sample())) for _ in range(6)]
    return [*told, digest(env.reset())]


@pytest.mark.parametrize("track", TRACK_NAMES)
def test_a_fork_and_a_state_put_back_go_on_as_the_first(track: str) -> None:
    env, other = (SingleEnv(track, **options(track, action_mode="multidiscrete")) for _ in range(2))
    env.reset(seed=8)
    some_steps(env, 1)
    state, fork = env.get_state(), env.fork()
    first = some_steps(env, 2)
    assert some_steps(fork, 2) == first
    other.set_state(state)  # in one that has never played
    assert some_steps(other, 2) == first
    env.set_state(state)
    assert some_steps(env, 2) == first


def test_forks_of_several_learners_keep_who_is_out() -> None:
    env = parallel_env("royale", **many_options("royale", action_mode="multidiscrete", zone={"phases": ()}))
    env.reset(seed=0)
    batch_of(env).state.agents.damage[0, 1] = 1000
    still = np.array([0, 0, 3, 2, 0, 0, 0, 0])
    env.step(dict.fromkeys(env.agents, still))
    fork = env.fork()
    assert fork.agents == env.agents == ["agent_0", "agent_2"]
    actions = dict.fromkeys(env.agents, still)
    assert digest(fork.step(actions)) == digest(env.step(actions))


def test_rows_of_vectors_and_single_environments_exchange_states() -> None:
    chosen = options("gathering", action_mode="multidiscrete", sensors={})
    vector, single = VectorArena("gathering", 2, **chosen), SingleEnv("gathering", **chosen)
    vector.reset(seed=3)
    vector.action_space.seed(0)
    actions = [vector.action_space.sample() for _ in range(4)]
    vector.step(actions[0])
    told, _ = single.set_state(vector.get_state(1))
    for action in actions[1:]:
        told, *_ = single.step(action[1])
        observation, *_ = vector.step(action)
        assert digest(told) == digest({name: values[1].copy() for name, values in observation.items()})
    batch = BatchedArena("gathering", 1, agents=1, **chosen)
    again = batch.set_state(0, single.get_state())
    assert again["position"].tolist() == [[told["position"].tolist()]]


@pytest.mark.parametrize("damage", [slice(0, 4), slice(-3, None), slice(60, 64)])
def test_damaged_states_are_refused(damage: slice) -> None:
    env = SingleEnv("navigation", **options("navigation", sensors={}))
    with pytest.raises(RuntimeError, match="reset"):
        env.get_state()
    env.reset(seed=0)
    state = bytearray(env.get_state())
    state[damage] = b"x" * len(state[damage])
    with pytest.raises(StateError):
        env.set_state(bytes(state))
