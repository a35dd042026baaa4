"""What is asked of environments is taken or refused alike in every kind; what is refused changes nothing."""

import functools
import re
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.engine.envs.common import OPEN, digest

from wildscav_engine.envs import BatchedArena, SingleEnv, VectorArena, parallel_env
from wildscav_engine.envs.registry import VERSION, VERSIONS, env_id
from wildscav_engine.envs.spaces.actions import MODES, ActionError
from wildscav_engine.specs.map_spec import MapConfig

KINDS: dict[str, Callable[..., Any]] = {
    "single": SingleEnv,
    "vector": lambda track, **options: VectorArena(track, 2, **options),
    "parallel": parallel_env,
    "batched": lambda track, **options: BatchedArena(track, 2, **options),
}
MANY = ("vector", "batched")
OTHER = MapConfig(size=40, houses=0, relief=0, water=0, vegetation=0.1)


def new(kind: str, track: str = "navigation", mode: str = "box", **more: Any) -> Any:
    options = {"map": OPEN, "sensors": {}, "action_mode": mode, "time_limit": 86_400, **more}
    return KINDS[kind](track, **options)


@functools.cache
def made(kind: str, track: str = "navigation", mode: str = "box") -> Any:
    env = new(kind, track, mode)
    env.reset(seed=1)
    return env


def states(env: Any) -> list[bytes]:
    """The states of all matches and of their sequences of episodes."""
    rows = env.arena.matches
    return [env.get_state(row) for row in range(rows)] if rows > 1 else [env.get_state()]


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_has_the_newest_observations_and_ids_those_of_their_number(kind: str) -> None:
    assert made(kind).config.version == VERSION
    for version in VERSIONS:
        assert gymnasium.spec(env_id("navigation", version)).kwargs["version"] == version


SEED = "must be a whole number, 0 or more$"
OPTIONS = "its options are start, start_range, target, map(, each)?(, reset_mask)?$"
OUTSIDE = "at x = 0.0, z = 99.0: outside the map"


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"seed": -1}, f"^seed is -1, {SEED}"),
        ({"seed": 1.5}, f"^seed is 1.5, {SEED}"),
        ({"seed": "7"}, f"^seed is '7', {SEED}"),
        (
            {"options": {"taget": (0, 0, 0)}},
            rf"^a reset has no option 'taget' .*'target'\?\); {OPTIONS}",
        ),
        ({"options": {"level": "easy"}}, f"^a reset has no option 'level'; {OPTIONS}"),
        ({"options": {3: 4}}, f"^a reset has no option '3'; {OPTIONS}"),
        ({"options": [1]}, r"^options is \[1\], must be a dictionary with some of start, start_range"),
        ({"options": {"map": "abc"}}, "^map: 'abc' is no map; allowed are a number, several, a MapSpec"),
        ({"options": {"map": 1.5}}, "^map: 1.5 is no map; allowed are a number"),
        ({"options": {"map": 1000}}, "^map: id is 1000; maps have the ids 1 to 999$"),
        ({"options": {"start": (1, 2)}}, r"^start: must have at least 3 values, not \(1, 2\)$"),
        ({"options": {"start_range": -1}}, "^start_range: Input should be greater than or equal to 0"),
        ({"options": {"start": (0, 0, 99)}}, f"^start is {OUTSIDE}"),
        ({"seed": 5, "options": {"target": (0, 0, 99)}}, f"^target is {OUTSIDE}"),
    ],
)
def test_what_is_refused_is_told_in_one_line_and_changes_nothing(
    wrong: dict[str, Any], message: str, kind: str
) -> None:
    env = made(kind)
    before = states(env)
    with pytest.raises(ValueError, match=message) as raised:
        env.reset(**wrong)
    assert "\n" not in str(raised.value)
    assert states(env) == before


@pytest.mark.parametrize("kind", MANY)
@pytest.mark.parametrize(
    "mask",
    [[0, 2], [True], [True] * 3, [False, False], [[True], [True, False]], np.array([1, 0]), "all", {0: True}],
)
def test_masks_are_one_flag_a_row(mask: Any, kind: str) -> None:
    env = made(kind)
    before = states(env)
    name = "mask" if kind == "batched" else "reset_mask"
    given = {"mask": mask} if kind == "batched" else {"options": {"reset_mask": mask}}
    with pytest.raises(ValueError, match=f"^{name} is .* must be bool of shape .2,. and True somewhere$"):
        env.reset(**given)
    assert states(env) == before


@pytest.mark.parametrize("kind", MANY)
def test_seeds_of_rows_may_be_listed_in_any_kind_of_integer(kind: str) -> None:
    env = made(kind)
    told = digest(env.reset(seed=3))
    for seeds in ([3, 4], (np.int64(3), np.int64(4)), np.array([3, 4])):
        assert digest(env.reset(seed=seeds)) == told
    with pytest.raises(ValueError, match=r"^3 seeds are given for 2 environments$"):
        env.reset(seed=[1, 2, 3])
    with pytest.raises(ValueError, match=f"^seed is -1, {SEED}"):
        env.reset(seed=[1, -1])


@pytest.mark.parametrize("kind", KINDS)
def test_a_reset_takes_the_maps_that_an_environment_is_made_with(kind: str) -> None:
    env = made(kind)
    for choice in (OTHER, {"size": 40, "houses": 0}, 104, (104,)):
        begun = new(kind, map=choice).reset(seed=2)
        assert digest(env.reset(seed=2, options={"map": choice})) == digest(begun)
    assert digest(env.reset(seed=2)) == digest(new(kind).reset(seed=2))


ANY = st.one_of(
    st.integers(-2, 2**66),
    st.integers(0, 2**62).map(np.int64),
    st.sampled_from([1.0, -0.5, np.nan, np.inf, "1", b"1", {}, np.float32(2), np.array(3), object]),
)


@given(seed=ANY)
def test_every_kind_takes_the_same_seeds(seed: Any) -> None:
    """Of one seed; only environments of many rows take lists of them."""
    told = set()
    for kind in KINDS:
        try:
            made(kind).reset(seed=seed)
            told.add("taken")
        except ValueError as error:
            told.add(str(error).split(",")[0])
    assert len(told) == 1


NUMBERS = st.one_of(
    st.integers(-1, 11), st.floats(-1.5, 1.5), st.sampled_from([np.nan, np.inf, 1e300, True, "1.0", None, {}])
)
BATCHES: dict[str, Callable[[Any], Any]] = {
    "single": lambda value: value,
    "vector": lambda value: [value] * 2,
    "parallel": lambda value: value,
    "batched": lambda value: [[value] * 4] * 2,
}


def refusal(kind: str, mode: str, action: Any) -> str:
    """Return with which words an environment refuses what all its learners do; none if it plays."""
    env, batch = made(kind, "gathering", mode), BATCHES[kind]
    named = isinstance(action, dict)
    given = {name: batch(value) for name, value in action.items()} if named else batch(action)
    before = states(env)
    try:
        env.step(dict.fromkeys(env.agents, given) if kind == "parallel" else given)
    except ActionError as error:
        told = str(error)
    else:
        return ""
    assert states(env) == before
    assert "\n" not in told
    return re.sub(r": .* must be numbers of shape .*", ": numbers", told)


@given(mode=st.sampled_from(list(MODES)), data=st.data())
def test_every_kind_takes_the_same_actions(mode: str, data: st.DataObject) -> None:
    space = made("single", "gathering", mode).action_space
    action: Any = data.draw(st.lists(NUMBERS, min_size=5, max_size=7))
    if mode == "baseline":
        action = action[0]
    elif mode == "dict":
        action = dict(zip(space.spaces, action, strict=False))
    told = {refusal(kind, mode, action) for kind in KINDS}
    assert len(told) == 1
