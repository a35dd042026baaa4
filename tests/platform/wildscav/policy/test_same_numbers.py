"""What the SDK makes of what arrives is what the environments return, bit for bit, on every track."""

from pathlib import Path
from typing import Any, Literal

import gymnasium
import numpy as np
import pytest
from tests.engine.envs.common import OPEN, TRACK_NAMES, options
from tests.platform.helpers.policy_matches import assert_same, observed, play_env

from wildscav_engine.envs import SingleEnv, describe
from wildscav_engine.envs.spaces.actions import MODES
from wildscav_engine.envs.spaces.columns import groups_of
from wildscav_engine.sensors import SENSORS

SMALL = {"width": 4, "height": 3}
# One of every kind that there is, small; a zone is there in royale alone.
EVERY_SENSOR: dict[str, dict[str, Any]] = {
    "depth": SMALL,
    "lidar": {},
    "camera": SMALL,
    "screen": SMALL,
    "segmentation": SMALL,
    "normals": SMALL,
    "visible_agents": {"limit": 3},
    "teammates": {"limit": 2},
    "nearby_supplies": {"limit": 4},
    "compass": {},
    "zone": {},
    "hot_spot": {},
    "sights": {"limit": 2},
    "to_hot_spot": {},
    "to_supplies": {"limit": 2},
    "to_waves": {},
}
MORE: dict[str, dict[str, Any]] = {
    "gathering": {"teammates": ("gatherer",)},
    "capture": {"teammates": ("walker",)},
}
# Enough shots, deaths and returns for six seconds.
ROUGH = {
    "map": OPEN,
    "time_limit": 8.0,
    "opponents": ("fighter-hard", "fighter-hard"),
    "starts": ((0.0, 0.0, 0.0), (6.0, 0.0, 3.0), (-5.0, 0.0, 4.0)),
    "rules": {
        "start_health": 20,
        "respawn_time": 0.5,
        "invincible_time": 0.4,
        "clip_size": 2,
        "reload_time": 0.5,
    },
}


def everything_of(track: str, **more: Any) -> dict[str, Any]:
    sensors = {name: wanted for name, wanted in EVERY_SENSOR.items() if name != "zone" or track == "royale"}
    return options(track, sensors=sensors, **MORE.get(track, {}), **more)


def test_the_test_covers_every_sensor() -> None:
    assert EVERY_SENSOR.keys() == SENSORS.keys()


# Flat rows hold the same arrays; version 1 has all groups of version 0.
@pytest.mark.parametrize(("version", "flat"), [(0, False), (1, False), (1, True)])
@pytest.mark.parametrize("track", TRACK_NAMES)
def test_every_track_and_sensor(track: str, version: Literal[0, 1], flat: bool, tmp_path: Path) -> None:
    chosen = everything_of(track, version=version, flat=flat, action_mode="multidiscrete")
    env = SingleEnv(track, **chosen)
    played = play_env(env, seed=4)
    told = observed(tmp_path, describe(env.config), played)
    assert len(told) == len(played.observations) >= 10
    for ours, theirs in zip(told, played.observations, strict=True):
        assert_same(ours, theirs)
        assert env.observation_space.contains(ours)


@pytest.mark.parametrize("track", ["navigation", "battle"])
@pytest.mark.parametrize("mode", MODES)
def test_every_action_mode_plays_the_same_match(mode: str, track: str, tmp_path: Path) -> None:
    env = SingleEnv(track, **options(track, sensors={}, action_mode=mode))
    played = play_env(env, seed=6)
    told = observed(tmp_path, describe(env.config), played)
    for ours, theirs in zip(told, played.observations, strict=True):
        assert_same(ours, theirs)


def test_a_rough_battle_in_which_every_column_takes_values(tmp_path: Path) -> None:
    """Health, weapon and returns are the columns that a quiet match leaves at 0."""
    chosen = options("battle", sensors={}, action_mode="multidiscrete", version=1)
    env = SingleEnv("battle", **(chosen | ROUGH))
    generator = np.random.default_rng(1)

    def shoot_often(_: Any) -> Any:
        choice = env.action_space.sample()
        choice[-2:] = generator.random() < 0.6, generator.random() < 0.2
        return choice

    played = play_env(env, seed=2, choose=shoot_often)
    told = observed(tmp_path, describe(env.config), played)
    for ours, theirs in zip(told, played.observations, strict=True):
        assert_same(ours, theirs)
    for group in ("vitals", "weapon", "to_box", "to_enemy"):
        columns = next(one.columns for one in groups_of(1).values() if one.name == group)
        for column, values in zip(columns, np.array([one[group] for one in told]).T, strict=True):
            if column.name != "hit":  # random shots hit nobody
                assert len(set(values.tolist())) > 1, column.name


def test_an_environment_that_holds_actions_longer_than_the_match(tmp_path: Path) -> None:
    """TrainedModel with the paper's 15 frames an action, played with 5: an action is held for three steps."""
    env = SingleEnv(
        "gathering",
        **options("gathering", sensors={}, frames_per_action=15, action_mode="baseline", time_limit=6.0),
    )
    played = play_env(env, seed=4, choose=lambda _: env.action_space.sample() | 1)  # odd ones pick up
    told = observed(
        tmp_path, describe(env.config), played, played.spec.model_copy(update={"frames_per_action": 5})
    )
    assert len(told) == len(played.observations) == 20
    for ours, theirs in zip(told, played.observations, strict=True):
        assert_same(ours, theirs)


@pytest.mark.parametrize("flat", [False, True], ids=["dict", "flat"])
def test_a_stack_is_that_of_gymnasiums_wrapper(flat: bool, tmp_path: Path) -> None:
    env = SingleEnv("navigation", **options("navigation", flat=flat, action_mode="baseline"))
    description = describe(env.config) | {"stack": {"count": 3, "axis": "new", "padding": "first"}}
    played = play_env(env, seed=4)
    stacked = gymnasium.wrappers.FrameStackObservation(env, 3)
    expected, _ = stacked.reset(seed=4)
    for ours, choice in zip(observed(tmp_path, description, played), played.choices, strict=True):
        assert_same(ours, expected)
        expected, *_ = stacked.step(choice)
