"""The PettingZoo environments: the library's own tests for every track, and what becomes of the dead."""

from typing import Any

import numpy as np
import pettingzoo
import pytest
from pettingzoo.test import api_test, parallel_api_test, parallel_seed_test, seed_test
from tests.engine.envs.common import FEW_BOXES, HOT_SPOT, TRACK_NAMES, batch_of, many_options

from wildscav_engine.envs import BatchedArena, aec_env, parallel_env
from wildscav_engine.envs.spaces.actions import MODES, ActionError

# What the library says of every Dict of observations and actions, which are allowed all the same.
DICTS = [
    pytest.mark.filterwarnings("ignore:Observation is not a NumPy array"),
    pytest.mark.filterwarnings("ignore:.* space for each agent probably should be"),
    pytest.mark.filterwarnings("ignore:Environment has not defined a render"),
]
pytestmark = DICTS
SENSORS = {"depth": {"width": 4, "height": 3}, "teammates": {"limit": 2}}


@pytest.mark.parametrize("track", TRACK_NAMES)
def test_every_track_passes_pettingzoos_own_tests(track: str) -> None:
    options = many_options(track, sensors=SENSORS)
    parallel_api_test(parallel_env(track, **options), 30)
    parallel_seed_test(lambda: parallel_env(track, **options), 30)
    api_test(aec_env(track, **options), 30)


@pytest.mark.parametrize("flat", [False, True], ids=["dict", "flat"])
@pytest.mark.parametrize("mode", MODES)
def test_every_action_mode_passes_pettingzoos_own_tests(mode: str, flat: bool) -> None:
    options = many_options("battle", sensors={}, action_mode=mode, flat=flat)
    parallel_api_test(parallel_env("battle", **options), 20)
    parallel_seed_test(lambda: parallel_env("battle", **options), 20)
    api_test(aec_env("battle", **options), 20)
    seed_test(lambda: aec_env("battle", **options), 20)


def test_a_mask_in_one_row_allows_what_the_tuple_allows() -> None:
    options = many_options("battle", sensors={}, action_mode="multidiscrete", flat=True)
    env = parallel_env("battle", **options)
    _, infos = env.reset(seed=0)
    space, mask = env.action_space("agent_0"), infos["agent_0"]["action_mask"].copy()
    mask[1:9] = 0  # stand
    mask[-2] = 0  # reload
    drawn = np.array([space.sample(mask) for _ in range(50)])
    assert not drawn[:, 0].any()
    assert drawn[:, -1].all()
    assert len(set(drawn[:, 2].tolist())) > 3


def still(env: Any) -> dict[str, Any]:
    return dict.fromkeys(env.agents, np.array([0, 0, 3, 2, *[0] * 4]))


def test_who_is_out_for_good_gets_last_values_and_leaves() -> None:
    env = parallel_env("royale", **many_options("royale", action_mode="multidiscrete", zone={"phases": ()}))
    env.reset(seed=0)
    damage = batch_of(env).state.agents.damage
    damage[0, 1] = 1000
    observations, rewards, terminated, truncated, infos = env.step(still(env))
    for told in (observations, rewards, terminated, truncated, infos):
        assert list(told) == ["agent_0", "agent_1", "agent_2"]
    assert (terminated["agent_1"], truncated["agent_1"], env.agents) == (True, False, ["agent_0", "agent_2"])
    assert infos["agent_1"]["metrics"]["placement"] == 3
    assert rewards["agent_0"] == pytest.approx(0.5)  # a place won
    told = env.step(still(env))
    assert all(list(part) == ["agent_0", "agent_2"] for part in told)
    damage[0, 2] = 1000
    _, _, terminated, _, _ = env.step(still(env))
    assert (terminated, env.agents) == ({"agent_0": True, "agent_2": True}, [])
    assert env.step({}) == ({}, {}, {}, {}, {})


def test_who_will_come_back_stays_and_may_do_one_thing() -> None:
    options = many_options("battle", action_mode="multidiscrete", rules={"respawn_time": 0.5})
    env = parallel_env("battle", **options)
    env.reset(seed=0)
    env.arena.batch.state.agents.damage[0, 1] = 1000
    alive, masks = [], []
    for _ in range(8):
        observations, *_, infos = env.step(still(env))
        alive.append(observations["agent_1"]["body"][0])
        masks.append(sum(mask.sum() for mask in infos["agent_1"]["action_mask"]))
        assert len(env.agents) == 3
    assert alive == [0, 0, 0, 0, 0, 1, 1, 1]
    assert masks == [8] * 5 + [9 + 2 + 7 + 5 + 2 * 4] * 3
    assert infos["agent_1"]["events"]["respawns"] == 0


def test_actions_have_to_be_for_those_who_act() -> None:
    env = parallel_env("battle", **many_options("battle", action_mode="multidiscrete"))
    env.reset(seed=0)
    actions = still(env)
    wanted = "must be a dictionary of agent_0, agent_1, agent_2$"
    with pytest.raises(ActionError, match=f"^actions: a dict of agent_0, {wanted}"):
        env.step({"agent_0": actions["agent_0"]})
    with pytest.raises(ActionError, match=f"^actions: a list, {wanted}"):
        env.step([0, 1])  # type: ignore[arg-type]


def test_pettingzoo_knows_the_tracks_by_name() -> None:
    for track in TRACK_NAMES:
        assert {f"wildscav/{track}-v0", f"wildscav/{track}-v1"} <= set(pettingzoo.parallel_registry)
    env = pettingzoo.make("parallel", "wildscav/battle_v1", **many_options("battle"))
    assert str(env) == "wildscav_battle_v1"
    assert env.possible_agents == ["agent_0", "agent_1", "agent_2"]


@pytest.mark.parametrize("track", ["gathering", "royale"])
def test_batched_matches_are_parallel_ones(track: str) -> None:
    more = {"sensors": {**SENSORS, "hot_spot": {}}, "supplies": FEW_BOXES | HOT_SPOT, "time_limit": 0.6}
    options = many_options(track, action_mode="multidiscrete", **more)
    batch = BatchedArena(track, 2, **options)
    alone = [parallel_env(track, **options) for _ in range(2)]
    told = batch.reset(seed=3)
    assert told["hot_spot"].any()
    starts = [env.reset(seed=3 + row)[0] for row, env in enumerate(alone)]
    batch.action_space.seed(0)
    for _ in range(6):
        for name, values in told.items():
            for row, start in enumerate(starts):
                for place, agent in enumerate(start):
                    assert values[row, place].tobytes() == start[agent][name].tobytes()
        actions = batch.action_space.sample()
        outcome = batch.step(actions)
        told, starts = outcome.observation, []
        for row, env in enumerate(alone):
            start, rewards, *_ = env.step({f"agent_{place}": actions[row, place] for place in range(3)})
            starts.append(start)
            assert env.state_space.contains(env.state())
            assert outcome.rewards[row].tolist() == list(rewards.values())
    assert outcome.ended == (0, 1)
    assert outcome.metrics.shape == (2, 3, len(batch.arena.metrics))


@pytest.mark.parametrize("mode", ["dict", "box", "baseline", "multidiscrete"])
def test_actions_of_batched_matches_have_the_axes_of_their_observations(mode: str) -> None:
    batch = BatchedArena("gathering", 2, **many_options("gathering", action_mode=mode))
    observation = batch.reset(seed=3)
    assert observation["position"].shape[:2] == (2, 3)
    actions = batch.action_space.sample()
    assert batch.action_space.contains(actions)
    batch.step(actions)

    def flat(values: np.ndarray) -> np.ndarray:
        return values.reshape(6, *values.shape[2:])

    in_a_row = {name: flat(values) for name, values in actions.items()} if mode == "dict" else flat(actions)
    with pytest.raises(ActionError, match=r"shape \(6,.*must be numbers of shape \(2, 3"):
        batch.step(in_a_row)
