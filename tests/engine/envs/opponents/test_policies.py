"""Policies in the seats behind the learners': they observe what learners would, once per step for all."""

import functools
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv
from pettingzoo.test import parallel_api_test, parallel_seed_test
from tests.engine.envs.common import batch_of, digest, env_id, many_options, options, play_alike

from wildscav_engine.envs import BatchedArena, PolicyOpponent, SingleEnv, VectorArena, parallel_env
from wildscav_engine.envs.spaces.actions import ActionError
from wildscav_engine.simulation.snapshot import StateError

SENSORS = {
    "depth": {"width": 4, "height": 3},
    "visible_agents": {"limit": 3},
    "nearby_supplies": {"limit": 2},
}
CHOICES = np.array([9, 2, 7, 5, 2, 2, 2, 2])  # of multidiscrete in battle
IDLE = np.array([0, 0, 3, 2, 0, 0, 0, 0])


def wander(observation: Any) -> np.ndarray:
    """Choose by the bits of each row alone, so that the other rows do not matter."""
    if isinstance(observation, dict):
        observation = np.concatenate([observation["position"], observation["time"]], axis=1)
    bits = np.ascontiguousarray(observation, np.float32).view(np.uint32).astype(np.int64).sum(axis=1)
    return (bits[:, np.newaxis] // np.arange(1, 9)) % CHOICES


class Witness:
    """Plays as ``wander`` does, and keeps what it observes."""

    name = "witness"

    def __init__(self) -> None:
        self.told: list[Any] = []

    def __call__(self, observation: Any) -> np.ndarray:
        self.told.append(observation)
        return wander(observation)


class Memory:
    """A policy with a memory: walks in the direction that its seed and the number of its steps give."""

    def __init__(self, seats: int) -> None:
        self.steps, self.seeds = np.full(seats, -1), np.zeros(seats, np.uint64)
        self.calls: list[tuple[str, list[int]]] = []

    def reset(self, rows: np.ndarray, seeds: np.ndarray) -> None:
        self.calls.append(("reset", rows.tolist()))
        self.steps[rows], self.seeds[rows] = 0, seeds

    def act(self, observation: Any, rows: np.ndarray) -> np.ndarray:
        self.calls.append(("act", rows.tolist()))
        actions = np.tile(IDLE, (len(rows), 1))
        actions[:, 0] = 1 + (self.seeds[rows] + self.steps[rows].astype(np.uint64)) % 8
        self.steps[rows] += 1
        return actions


def battle(**more: Any) -> dict[str, Any]:
    return options(
        "battle", **{"sensors": SENSORS, "action_mode": "multidiscrete", "time_limit": 0.8, **more}
    )


@pytest.mark.parametrize("flat", [False, True])
def test_a_policy_observes_and_does_what_a_learner_in_its_seat_would(flat: bool) -> None:
    witness = Witness()
    vector = VectorArena("battle", 3, **battle(opponents=(witness, "walker", witness), flat=flat))
    several = many_options("battle", agents=4, sensors=SENSORS, action_mode="multidiscrete", time_limit=0.8)
    batch = BatchedArena("battle", 3, **several, flat=flat)
    ours, _ = vector.reset(seed=5)
    theirs = batch.reset(seed=5)
    for step in range(20):  # two ends of episodes
        flattened = wander(_joined(theirs)).reshape(3, 4, -1)
        assert digest(_seat(theirs, 0)) == digest(ours)
        asked = len(witness.told)
        ours, *_ = vector.step(flattened[:, 0])
        if step % 9 == 8:
            assert len(witness.told) == asked  # all matches are being reset
        else:
            (told,) = witness.told[asked:]
            assert digest(told) == digest(_seats(theirs, [1, 3]))
        flattened[:, 2] = IDLE
        batch_of(batch).state.agents.robot[:] = batch_of(vector).state.agents.robot
        batch_of(batch)._has_robots = True
        theirs = batch.step(flattened).observation


def _joined(observation: Any) -> Any:
    if isinstance(observation, dict):
        return {name: values.reshape(-1, *values.shape[2:]) for name, values in observation.items()}
    return observation.reshape(-1, observation.shape[-1])


def _seats(observation: Any, seats: list[int]) -> Any:
    if isinstance(observation, dict):
        return _joined({name: values[:, seats] for name, values in observation.items()})
    return _joined(observation[:, seats])


def _seat(observation: Any, seat: int) -> Any:
    return _seats(observation, [seat])


@pytest.mark.parametrize("mode", AutoresetMode)
@pytest.mark.parametrize("track", ["battle", "royale"])
def test_rows_are_single_environments_in_every_autoreset_mode(track: str, mode: AutoresetMode) -> None:
    made: dict[str, Any] = {"sensors": SENSORS, "action_mode": "multidiscrete", "time_limit": 0.8}
    chosen = options(track, **made, opponents=(wander, "fighter"))
    ours = VectorArena(track, 3, autoreset_mode=mode, **chosen)
    play_alike(ours, SyncVectorEnv([lambda: SingleEnv(track, **chosen)] * 3, autoreset_mode=mode))


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_the_first_observation_of_an_episode_is_of_that_episode(mode: AutoresetMode) -> None:
    witness = Witness()
    vector = VectorArena("battle", 2, autoreset_mode=mode, **battle(opponents=(witness,), sensors={}))
    vector.reset(seed=0)
    for _ in range(26 if mode == AutoresetMode.NEXT_STEP else 24):
        vector.step(np.tile(IDLE, (2, 1)))
    steps = [(told["time"][:, 1] * 10).round().tolist() for told in witness.told]
    assert steps == [[step] * 2 for step in (*range(8), *range(8), *range(8))]


def test_a_policy_with_a_memory_is_told_which_seats_begin_anew() -> None:
    memory = Memory(seats=6)
    vector = VectorArena("battle", 3, **battle(opponents=("walker", memory), sensors={}, time_limit=0.2))
    vector.reset(seed=1)
    for _ in range(3):
        vector.step(np.tile(IDLE, (3, 1)))
    vector.reset(options={"reset_mask": np.array([False, True, False])})
    act = ("act", [1, 3, 5])
    assert memory.calls == [("reset", [1, 3, 5]), act, act, ("reset", [1, 3, 5]), ("reset", [3])]
    assert len(set(memory.seeds[[1, 3, 5]].tolist())) == 3


def test_a_seed_makes_a_policy_with_a_memory_repeat_itself() -> None:
    def played(matches: int, seed: int) -> list[Any]:
        vector = VectorArena("battle", matches, **battle(opponents=(Memory(2 * matches),) * 2))
        vector.reset(seed=seed)
        steps = [vector.step(np.tile(IDLE, (matches, 1)))[0] for _ in range(20)]
        return [digest({name: values[-1].copy() for name, values in seen.items()}) for seen in steps]

    assert played(3, seed=4) == played(1, seed=6) == played(1, seed=6)


@pytest.mark.parametrize("mode", ["dict", "box", "baseline", "multidiscrete"])
def test_a_policy_may_have_sensors_and_actions_of_its_own(mode: Any) -> None:
    told: list[Any] = []

    def policy(observation: Any) -> Any:
        told.append(observation)
        return own.action_space.sample()

    own = VectorArena("battle", 4, **battle(sensors={"compass": {}}, flat=True, action_mode=mode))
    own.action_space.seed(0)
    opponent = PolicyOpponent(policy, sensors={"compass": {}}, flat=True, action_mode=mode)
    vector = VectorArena("battle", 2, **battle(opponents=(opponent, wander, opponent)))
    vector.reset(seed=2)
    observation, *_ = vector.step(np.tile(IDLE, (2, 1)))
    assert vector.observation_space.contains(observation)
    assert [seen.shape for seen in told] == [(4, *own.single_observation_space.shape)]
    assert own.observation_space.contains(told[0])
    assert vector.arena.actions[:, [1, 3]].any(axis=2).all()


def test_teammates_may_be_policies_and_the_dead_are_asked_too() -> None:
    witness = Witness()
    chosen = options("royale", sensors={}, action_mode="multidiscrete", opponents=(witness, "walker"))
    env = SingleEnv("royale", teammates=(witness,), **chosen)
    env.reset(seed=0)
    (spec,), agents = batch_of(env).specs, batch_of(env).state.agents
    assert spec.seats == ("submission", "submission", "submission", "walker")
    assert spec.team_of_seats == (0, 0, 1, 2)
    agents.damage[0, 2] = 1000
    for _ in range(3):
        env.step(IDLE)
    assert [told["body"][:, 0].tolist() for told in witness.told] == [[1, 1], [1, 0], [1, 0]]
    assert not agents.velocity[0, 2].any()


def test_several_learners_may_have_policies_as_opponents() -> None:
    chosen = many_options("battle", action_mode="multidiscrete", opponents=(wander, "walker"))
    parallel_api_test(parallel_env("battle", **chosen), num_cycles=40)
    chosen = many_options("battle", action_mode="baseline", sensors={}, opponents=(_baseline,))
    parallel_seed_test(functools.partial(parallel_env, "battle", **chosen), num_cycles=20)


def _baseline(observation: dict[str, np.ndarray]) -> np.ndarray:
    return np.arange(len(observation["time"])) % 48


def test_gymnasiums_checker_finds_nothing_and_copies_play() -> None:
    check_env(SingleEnv("battle", **battle(opponents=(wander, "walker"))), skip_render_check=True)
    env = gymnasium.make(env_id("battle"), **battle(opponents=(wander,)))
    env.reset(seed=3)
    wanted = [env.step(IDLE)[0]["position"] for _ in range(3)]
    assert env.spec is not None
    vector = AsyncVectorEnv([lambda: SingleEnv("battle", **battle(opponents=(wander,)))] * 2)
    try:
        vector.reset(seed=[3, 4])
        got = [vector.step(np.tile(IDLE, (2, 1)))[0]["position"][0] for _ in range(3)]
    finally:
        vector.close()
    np.testing.assert_array_equal(got, wanted)


@pytest.mark.parametrize(
    ("returned", "mode", "message"),
    [
        (lambda n: np.full((n, 8), 9), "multidiscrete", r"must be from 0 to \[8, 1"),
        (lambda _: None, "box", r"must be numbers of shape \(4, 8\)"),
        (lambda n: [[0.0]] * (n - 1) + [[0.0, 1.0]], "box", ""),
        (lambda n: {"jump": np.zeros(n)}, "dict", "must be a dictionary of"),
    ],
)
def test_what_is_no_action_is_refused_by_the_name_of_the_opponent(
    returned: Callable[[int], Any], mode: Any, message: str
) -> None:
    opponent = PolicyOpponent(lambda seen: returned(len(seen["time"])), name="odd", action_mode=mode)
    vector = VectorArena("battle", 2, **battle(opponents=(opponent,) * 2))
    vector.reset(seed=0)
    with pytest.raises(ActionError, match=f"^the opponent 'odd': .*{message}"):
        vector.step(np.tile(IDLE, (2, 1)))


@pytest.mark.parametrize(
    ("opponent", "message"),
    [
        (7, "7 cannot play; allowed are"),
        (Memory, "Memory is a class, must be an object"),
        (lambda: None, r"must take \(observations\)"),
        (type("Half", (), {"act": lambda self, observations, rows: None})(), "Half.reset is missing"),
        (type("Odd", (), dict.fromkeys(("act", "reset"), lambda self, one: None))(), r"take \(rows, seeds\)"),
        (PolicyOpponent(wander, sensors={"sonar": {}}), "the opponent 'wander': .*no sensor 'sonar'"),
    ],
)
def test_what_cannot_play_is_refused(opponent: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        SingleEnv("battle", **battle(opponents=(opponent,)))


def test_a_state_continues_against_the_same_policies_and_no_others() -> None:
    chosen = battle(opponents=(wander, "walker"), time_limit=3.0)
    env, other = SingleEnv("battle", **chosen), SingleEnv("battle", **chosen)
    env.reset(seed=3)
    env.step(IDLE)
    state, fork = env.get_state(), env.fork()
    wanted = [digest(env.step(IDLE)) for _ in range(3)]
    other.set_state(state)
    for again in (fork, other):
        assert [digest(again.step(IDLE)) for _ in range(3)] == wanted
    for others, message in (
        (("walker", "walker"), r"other players \(wander, walker\) than here \(walker, walker\)"),
        ((Witness(), "walker"), "a match with 'wander' where 'witness' plays here"),
        ((wander,), "other players"),
    ):
        with pytest.raises(StateError, match=message):
            SingleEnv("battle", **battle(opponents=others)).set_state(state)
    forgetful = SingleEnv("battle", **battle(opponents=(Memory(1),)))
    forgetful.reset(seed=0)
    with pytest.raises(StateError, match="the opponent 'Memory' has a memory of its own"):
        forgetful.fork()
