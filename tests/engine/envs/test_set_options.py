"""Options that change between episodes: what a curriculum needs, without a new environment."""

from typing import Any

import numpy as np
import pytest
from gymnasium.vector import SyncVectorEnv
from tests.engine.envs.common import (
    FEW_BOXES,
    OPEN,
    SMALL,
    batch_of,
    digest,
    many_options,
    options,
    play_alike,
)

from wildscav_engine.envs import BatchedArena, SingleEnv, parallel_env
from wildscav_engine.envs.vector import VectorArena

BARE: dict[str, Any] = {"sensors": {}, "action_mode": "multidiscrete"}


def away(observation: Any) -> Any:
    """The distance of the target, m."""
    return observation["target"][..., 7]


def test_what_was_changed_is_as_if_made_so() -> None:
    changes: dict[str, Any] = {"map": OPEN, "start_range": 4.0, "time_limit": 0.6, "split": "test"}
    changed = SingleEnv("navigation", **options("navigation", **BARE))
    changed.reset(seed=1)
    changed.set_options(**changes)
    made = SingleEnv("navigation", **(options("navigation", **BARE) | changes))
    for env in (changed, made):
        env.action_space.seed(1)
    assert digest(changed.reset(seed=4)) == digest(made.reset(seed=4))
    for _ in range(6):
        action = made.action_space.sample()
        assert digest(changed.step(action)) == digest(made.step(action))
    assert digest(changed.fork().reset(seed=5)) == digest(made.fork().reset(seed=5))


def test_boxes_goals_and_zones_change_too() -> None:
    env = SingleEnv("gathering", **options("gathering", **BARE))
    env.reset(seed=1)
    env.set_options(supplies=FEW_BOXES | {"spacing": 3}, supply_goal=1, time_limit=3.0)
    env.reset(seed=1)
    assert env.arena.template.supply_goal == 1
    royale = SingleEnv("royale", **options("royale", **BARE, zone={"phases": ()}))
    royale.reset(seed=1)
    royale.set_options(zone=None)
    royale.reset(seed=1)
    assert batch_of(royale).state.matches.phases[0] > 0


@pytest.mark.parametrize(
    "made", [{"preset": "ladder-battle", "level": "easy"}, {"map": OPEN}], ids=["ladder", "map"]
)
def test_a_level_that_would_change_nothing_is_refused(made: dict[str, Any]) -> None:
    env = SingleEnv("battle", **BARE, **made)
    before = env.config
    with pytest.raises(
        ValueError, match=r"^level has no effect with a map; a ladder's level is chosen where"
    ):
        env.set_options(level="expert")
    assert env.config == before
    env.set_options(level=before.level, time_limit=1.0)
    env.set_options(map=None, level="expert", random_maps=1)  # other maps, with the company of before
    assert (env.config.level, env.config.seats) == ("expert", before.seats)


def test_a_fork_keeps_the_company_of_a_ladder() -> None:
    env = SingleEnv("battle", **BARE, preset="ladder-battle", level="easy")
    env.set_options(map=OPEN, time_limit=1.0)
    env.set_options(map=(101,), level="hard")
    env.set_options(map=OPEN)
    env.reset(seed=1)
    fork = env.fork()
    assert fork.config == env.config
    still = np.zeros_like(env.action_space.sample())
    assert digest(fork.step(still)) == digest(env.step(still))


def test_a_level_changes_the_maps_and_leaves_those_that_were_made() -> None:
    env = SingleEnv("navigation", **BARE, level="easy", random_maps=1)
    easy = env.arena.pool
    env.set_options(level="normal", start_range=5.0)
    assert (env.arena.pool.specs(0)[0].config.size, easy.specs(0)[0].config.size) == (200, 100)
    env.set_options(start_range=6.0)
    normal = env.arena.pool
    assert normal.specs(0)[0].config.size == 200
    env.set_options(level="easy")
    assert env.arena.pool is easy


def test_rewards_change_with_the_next_episode_of_each_row() -> None:
    rewards = {"walked": 1.0, "step": 0.0}
    env = VectorArena("navigation", 2, **options("navigation", **BARE, rewards=rewards, time_limit=0.4))
    env.reset(seed=1)
    walk = np.tile(np.array([1, 1, 3, 2, 0]), (2, 1))
    env.reset(options={"reset_mask": np.array([True, False])})
    env.step(walk)
    env.reset(options={"reset_mask": np.array([False, True])})  # the rows are one step apart
    env.set_options(rewards={"step": 2.0})
    paid = np.array([env.step(walk)[1] for _ in range(7)])
    first = [(column == 2.0).argmax() for column in paid.T]
    assert first == [4, 5]  # after what is left of four steps, and one step in which a row is reset
    for row, begun in enumerate(first):
        assert (paid[:begun, row] < 2.0).all()


def test_rows_stay_single_environments() -> None:
    chosen = options("navigation", **BARE, time_limit=0.4, rewards={"walked": 1.0, "approach": 0.0})
    ours = VectorArena("navigation", 3, autoreset_mode="SameStep", **chosen)
    theirs = SyncVectorEnv([lambda: SingleEnv("navigation", **chosen)] * 3, autoreset_mode="SameStep")

    def change(step: int) -> None:
        if step == 2:
            for env in (ours, *theirs.envs):
                env.set_options(start_range=2.0, rewards={"approach": 1.0})  # type: ignore[attr-defined]

    play_alike(ours, theirs, steps=12, before=change)


def test_several_learners_have_it_too() -> None:
    chosen = many_options("capture", **BARE, map=SMALL, start_range=3.0)
    env, batch = parallel_env("capture", **chosen), BatchedArena("capture", 2, **chosen)
    changes: dict[str, Any] = {"time_limit": 0.4, "rewards": {}}
    env.set_options(**changes)
    batch.set_options(**changes)
    assert env.config == batch.config
    assert env.config.time_limit == 0.4
    observations, arrays = env.reset(seed=3)[0], batch.reset(seed=3)
    np.testing.assert_array_equal(observations["agent_1"]["position"], arrays["position"][0, 1])  # type: ignore[call-overload, index]
    assert set(env.fork().config.reward_weights.values()) == {0.0}


def test_a_reset_sets_the_range_of_starts_for_one_episode() -> None:
    env = SingleEnv("navigation", **options("navigation", **BARE))
    near = [away(env.reset(seed=seed, options={"start_range": 2.0})[0]) for seed in range(6)]
    far = [away(env.reset(seed=seed)[0]) for seed in range(6)]
    assert max(near) < np.mean(far)
    envs = VectorArena("navigation", 2, **options("navigation", **BARE))
    observations, _ = envs.reset(seed=0, options={"start_range": 2.0})
    assert away(observations).tolist() == near[:2]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"agents": 2}, "^agents cannot change between episodes; these options can: map, level, split"),
        ({"sensors": {}}, "^sensors cannot change between episodes"),
        ({"start_range": -1.0}, "start_range: Input should be greater than or equal to 0"),
        ({"level": "simple"}, "level: Input should be 'easy', 'normal', .*'extreme' or 'expert'"),
        ({"unseen": True}, "^unseen is True, but map names fixed maps; only random maps"),
        ({"rewards": {"luck": 1.0}}, "there is no reward term 'luck'"),
        (
            {"rewards": {"step": 1.0}},
            r"^rewards: 'step' is not among .*\(target_reached\): name it there, with the weight 0$",
        ),
    ],
)
def test_changes_that_are_impossible_are_refused_and_change_nothing(
    wrong: dict[str, Any], message: str
) -> None:
    env = SingleEnv("navigation", **options("navigation", **BARE))
    before = env.config
    with pytest.raises(ValueError, match=message) as raised:
        env.set_options(**wrong)
    assert "\n" not in str(raised.value)
    assert env.config == before


def test_a_hot_spot_comes_and_goes_only_where_sensors_are_named() -> None:
    moving = FEW_BOXES | {"hot_spot": {"boxes": 2, "places": 2}}
    env = SingleEnv("gathering", **options("gathering", action_mode="box"))
    with pytest.raises(ValueError, match="a hot spot that comes or goes would change what is observed"):
        env.set_options(supplies=moving)
    env = SingleEnv("gathering", **options("gathering", action_mode="box", sensors={"hot_spot": {}}))
    assert not env.reset(seed=1)[0]["hot_spot"].any()
    env.set_options(supplies=moving)
    assert env.reset(seed=1)[0]["hot_spot"].any()


@pytest.mark.parametrize("make", [VectorArena, BatchedArena])
def test_rows_have_options_of_their_own(make: Any) -> None:
    made = options("navigation", **BARE, agents=1, rewards={"step": 1.0})
    envs = make("navigation", 3, **made)
    envs.set_options(rows=[0, 2], map=OPEN, start_range=4.0, rewards={"step": 2.0})
    envs.set_options(rows=[2], time_limit=0.4)
    envs.set_options(split="test")  # all rows, whatever else they have
    own: dict[str, Any] = made | {"map": OPEN, "start_range": 4.0, "rewards": {"step": 2.0}, "split": "test"}
    singles = [
        SingleEnv("navigation", **one) for one in (own, made | {"split": "test"}, own | {"time_limit": 0.4})
    ]
    seen = envs.reset(seed=5)
    seen = seen[0] if make is VectorArena else seen
    shape = (3,) if make is VectorArena else (3, 1)
    for row, env in enumerate(singles):
        np.testing.assert_array_equal(seen["target"][row].reshape(-1), env.reset(seed=5 + row)[0]["target"])
    for _ in range(4):
        _, rewards, _, truncated, *_ = envs.step(np.tile(np.array([0, 0, 3, 2, 0]), (*shape, 1)))
        assert rewards.reshape(-1).tolist() == [2.0, 1.0, 2.0]
    assert truncated.reshape(-1).tolist() == [False, False, True]
    assert (envs.config.map, envs.config.split) == (SMALL, "test")
    for rows in ([3], [True, False]):
        with pytest.raises(ValueError, match=r"^rows is \[.*\], must be a list of numbers from 0 to 2$"):
            envs.set_options(rows=rows, map=OPEN)
    with pytest.raises(ValueError, match=r"^start_range: "):
        envs.set_options(rows=[], start_range=-1.0)


@pytest.mark.parametrize("make", [VectorArena, BatchedArena])
def test_a_reset_takes_options_for_each_row(make: Any) -> None:
    envs = make("navigation", 3, **options("navigation", **BARE, agents=1))
    each = [{"map": OPEN}, None, {"start_range": 2.0, "map": (101, 102)}]
    envs.reset(seed=5, options={"each": each, "start_range": 9.0})
    wanted = [{"map": OPEN, "start_range": 9.0}, {"start_range": 9.0}, each[2]]
    single = SingleEnv("navigation", **options("navigation", **BARE))
    for row, one in enumerate(wanted):
        single.reset(seed=5 + row, options=one)
        assert batch_of(envs).specs[row] == batch_of(single).specs[0]
    before = [envs.get_state(row) for row in range(3)]
    for wrong, message in (
        ([{}], r"^each is \[\{\}\], must be a list of 3 dictionaries, one for each row$"),
        ([{}, {"taget": 1}, {}], r"^a reset has no option 'taget' \(did you mean 'target'\?\); its options"),
        ([{}, {"map": 1000}, {}], "^map: id is 1000"),
    ):
        with pytest.raises(ValueError, match=message):
            envs.reset(options={"each": wrong})
        assert [envs.get_state(row) for row in range(3)] == before
