"""Rewards and observations of a user's own: called once a step for all learners, the same in every kind."""

import copy
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Box
from gymnasium.vector import SyncVectorEnv
from numpy.typing import NDArray
from tests.engine.envs.common import OPEN, batch_of, digest, env_id, many_options, options, play_alike

from wildscav_engine.envs import BatchedArena, Learners, SingleEnv, VectorArena, describe, parallel_env
from wildscav_engine.specs.actions import Field

PLAIN: dict[str, Any] = {"sensors": {}, "action_mode": "multidiscrete", "time_limit": 0.6}
WALK = np.array([5, 1, 3, 2, 0])  # back, at 10 m/s
FIGHT = np.array([5, 1, 3, 2, 0, 0, 0, 0])


def speed(now: Learners) -> NDArray[np.float64]:
    """The speed over ground, m/s."""
    velocity = now.of(now.state.agents.velocity)
    return np.hypot(velocity[:, 0], velocity[:, 2])


class Trail:
    """How many steps each learner has played in its episode, by a memory; and where it is."""

    space = Box(np.float32([0, -500]), np.float32([100, 500]))

    def __init__(self) -> None:
        self.steps: dict[tuple[int, int], int] = {}
        self.asked: list[int] = []

    def __call__(self, now: Learners) -> NDArray[np.float64]:
        self.asked.append(len(now.matches))
        pairs = list(zip(now.matches.tolist(), now.seats.tolist(), strict=True))
        for pair, is_new in zip(pairs, now.is_new, strict=True):
            self.steps[pair] = 0 if is_new else self.steps[pair] + 1
        return np.stack([[self.steps[pair] for pair in pairs], now.of(now.state.agents.position)[:, 2]], 1)


def own(**more: Any) -> dict[str, Any]:
    return {"reward_functions": {"speed": speed}, "observers": {"trail": Trail()}, **more}


def test_what_functions_pay_is_added_to_the_terms_and_told_by_name() -> None:
    env = SingleEnv("navigation", **options("navigation", **PLAIN, map=OPEN, rewards={"step": 2.0}), **own())
    seen, info = env.reset(seed=1)
    assert info["reward_terms"] == {"step": 0.0, "speed": 0.0}
    assert seen["trail"].tolist() == [0.0, seen["position"][2]]
    env.step(WALK)
    seen, reward, _, _, info = env.step(WALK)
    assert info["reward_terms"] == {"step": 2.0, "speed": 10.0}
    assert reward == 12.0
    assert seen["trail"].tolist() == [2.0, seen["position"][2]]
    assert env.observation_space.contains(seen)


@pytest.mark.parametrize("mode", ["SameStep", "NextStep"])
def test_rows_are_single_environments(mode: Any) -> None:
    chosen, trail = options("gathering", **PLAIN), Trail()
    ours = VectorArena("gathering", 3, autoreset_mode=mode, **chosen, **own(observers={"trail": trail}))
    singles = [lambda: SingleEnv("gathering", **chosen, **own())] * 3
    play_alike(ours, SyncVectorEnv(singles, autoreset_mode=mode), steps=15)
    assert set(trail.asked) == {3}  # all rows in one call, also when they begin anew


def test_rows_that_are_not_played_are_not_asked() -> None:
    trail = Trail()
    env = VectorArena("navigation", 2, **options("navigation", **PLAIN), **own(observers={"trail": trail}))
    env.reset(seed=1)
    seen: Any = env.step(np.tile(WALK, (2, 1)))[0]
    seen["trail"][:] = 77.0  # what users do to their arrays is their own business
    seen, _ = env.reset(options={"reset_mask": np.array([False, True])})
    assert seen["trail"][:, 0].tolist() == [1.0, 0.0]
    assert trail.asked == [2, 2, 1]


def test_several_learners_are_asked_together_and_nothing_is_paid_after_the_end() -> None:
    chosen = many_options("royale", **PLAIN, rewards={}, teams=(0, 1, 2))
    trail = Trail()
    env = parallel_env("royale", **chosen, **own(observers={"trail": trail}))
    batch = BatchedArena("royale", 2, **chosen, **own())
    env.reset(seed=3)
    batch.reset(seed=3)
    for _ in range(4):
        for one in (env, batch):
            batch_of(one).state.agents.eliminated[0, 2] = 5
        seen, rewards, *_ = env.step(dict.fromkeys(env.agents, FIGHT))
        outcome: Any = batch.step(np.tile(FIGHT, (2, 3, 1)))
        for seat, agent in enumerate(env.agents):
            assert digest(seen[agent]["trail"]) == digest(outcome.observation["trail"][0, seat])
            assert rewards[agent] == outcome.rewards[0, seat] > 0.0
    assert set(trail.asked) == {3}
    assert env.agents == ["agent_0", "agent_1"]
    assert outcome.rewards[0, 2] == 0.0


def test_actions_are_those_that_were_played() -> None:
    told: list[Any] = []

    def effort(now: Learners) -> Any:
        told.append(now.actions[:, Field.TURN].tolist())
        return -0.1 * np.abs(now.actions[:, Field.TURN])

    env = SingleEnv("navigation", **options("navigation", **PLAIN), reward_functions={"effort": effort})
    env.reset(seed=1)
    env.step(np.array([1, 1, 6, 2, 0]))  # 45 degrees in 5 frames
    env.reset()
    assert told == [[0.0], [9.0], [0.0]]


def test_opponents_with_policies_observe_the_same() -> None:
    told = []

    def policy(observations: Any) -> Any:
        told.append(observations["trail"][:, 0].tolist())
        return np.tile(FIGHT, (len(observations["trail"]), 1))

    chosen = options("battle", **PLAIN) | {"opponents": (policy, "walker", policy), **own()}
    env = SingleEnv("battle", **chosen)
    env.reset(seed=1)
    for _ in range(3):
        env.step(np.zeros(8, int))
    assert told == [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]


def test_states_and_forks_go_on_alike() -> None:
    chosen = options("navigation", **PLAIN) | {"reward_functions": {"speed": speed}}
    env = SingleEnv("navigation", **chosen, observers={"trail": Trail()})
    env.reset(seed=1)
    env.step(WALK)
    state, fork, twin = env.get_state(), env.fork(), copy.deepcopy(env)
    told = [digest(one.step(WALK)) for one in (env, twin)]
    assert told[0] == told[1]
    env.set_state(state)
    (after, *rest), (other, *same) = env.step(WALK), fork.step(WALK)
    assert digest([after, *rest]) == digest([other, *same])
    assert after["trail"][0] == 1.0  # since the state was restored: a memory is no part of it


def test_a_fork_copies_an_object_that_pays_and_observes_once() -> None:
    both = {"x": Fixed(0.5, Box(-1, 1, ()))}
    env = SingleEnv("navigation", **options("navigation", **PLAIN), reward_functions=both, observers=both)
    env.reset(seed=1)
    config = env.fork().config
    assert config.observers["x"] is config.reward_functions["x"] is not both["x"]


def test_nothing_of_the_match_can_be_written() -> None:
    def near(now: Learners) -> Any:
        assert now.maps[0].spec == now.specs[0].map
        arrays = (*now.state.agents, *now.state.supplies, *now.state.matches, *now.seen)
        assert not any(array.flags.writeable for array in arrays)
        return now.of(now.seen.agent_count)

    SingleEnv("battle", **options("battle", **PLAIN), reward_functions={"near": near}).reset(seed=1)


def test_processes_take_what_can_be_pickled() -> None:
    chosen: Any = options("navigation", **PLAIN, flat=True) | own(observers={"x": Fixed((0.5, -1))})
    many = [
        gymnasium.make_vec(env_id("navigation"), num_envs=2, vectorization_mode=mode, **chosen)
        for mode in ("async", "sync", "vector_entry_point")
    ]
    told = []
    for envs in many:
        seen, _ = envs.reset(seed=1)
        played = [envs.step(np.tile(WALK, (2, 1)))[:4] for _ in range(7)]
        told.append(digest([seen, *played]))
        envs.close()
    assert told[0] == told[1] == told[2]


KINDS: Any = {
    "single": SingleEnv,
    "vector": lambda track, **more: VectorArena(track, 2, **more),
    "parallel": lambda track, **more: parallel_env(track, agents=1, **more),
    "batched": lambda track, **more: BatchedArena(track, 2, agents=1, **more),
}


class Fixed:
    """An observer that always returns the same."""

    def __init__(self, value: Any, space: Any = None) -> None:
        self.value, self.space = value, Box(-1, 1, (2,)) if space is None else space

    def __call__(self, now: Learners) -> Any:
        return [self.value] * len(now.matches)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (
            Fixed(0.5),
            r"^the observer 'x' returned float64 of shape \(.,\), must be float32 of shape \(., 2\)",
        ),
        (Fixed((1.0, float("nan"))), "^the observer 'x' returned a number that is not finite$"),
        (Fixed((1.0, 1e300)), "^the observer 'x' returned a number that is not finite$"),
        (Fixed((1.0, 1.5)), "^the observer 'x' returned a number outside its space, Box"),
        (Fixed(0.5, Box(0, 255, (), np.uint8)), "^the observer 'x' returned float64 .*, must be uint8"),
        (lambda now: np.zeros(7), r"^the reward function 'x' returned float64 of shape \(7,\), must be"),
        (lambda now: [None], "^the reward function 'x' returned object of shape"),
        (lambda now: now.seats + np.inf, "^the reward function 'x' returned a number that is not finite$"),
    ],
)
def test_what_is_returned_wrongly_is_told_in_one_sentence(wrong: Any, message: str, kind: str) -> None:
    name = "observers" if isinstance(wrong, Fixed) else "reward_functions"
    env = KINDS[kind]("navigation", **options("navigation", **PLAIN), **{name: {"x": wrong}})
    with pytest.raises(ValueError, match=message) as raised:
        env.reset(seed=1)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"reward_functions": {"x": 3}}, "^reward_functions: 'x' is 3, must be a function or an object that"),
        ({"reward_functions": {"x": Trail}}, "^reward_functions: 'x' is <class .*, must be a function"),
        ({"reward_functions": {"x": lambda: 0}}, "^reward_functions: 'x' must take one argument, the learn"),
        ({"reward_functions": {"step": speed}}, "^reward_functions: 'step' is the name of a reward term"),
        ({"reward_functions": speed}, "^reward_functions: Input should be a valid dictionary"),
        ({"observers": {"x": speed}}, "^observers: the space of 'x' is None, must be a Box of numbers$"),
        ({"observers": {"view": Trail()}}, "^observers: 'view' is already part of the observation"),
    ],
)
def test_what_cannot_be_called_is_refused(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message) as raised:
        SingleEnv("navigation", **options("navigation", **PLAIN), **wrong)
    assert "\n" not in str(raised.value)


def test_agents_without_the_engine_have_no_observers() -> None:
    env = SingleEnv("navigation", **options("navigation", **PLAIN), **own())
    with pytest.raises(ValueError, match=r"^the observers trail need the engine: an agent has none$"):
        describe(env.config)
