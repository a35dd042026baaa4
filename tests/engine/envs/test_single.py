"""The Gymnasium environments: the library's own tests for every track, action mode and sensor, and ours."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from tests.engine.envs.common import OPEN, SMALL, TRACK_NAMES, batch_of, digest, env_id, options

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.settings.episodes import Episodes, Plan
from wildscav_engine.envs.settings.options import EnvOptions
from wildscav_engine.envs.single import SingleEnv
from wildscav_engine.envs.spaces.actions import MODES
from wildscav_engine.envs.spaces.columns import EVENTS
from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.sensors import SENSORS
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.tracks import TRACKS

SEEN = MapConfig(pieces="seen")
TINY = {"depth": {"width": 4, "height": 3}, "camera": {"width": 8, "height": 6}, "lidar": {"azimuths": 8}}


def played(env: gymnasium.Env[Any, Any], seed: int, action_seed: int = 0) -> list[Any]:
    """Return everything that an episode of random actions tells."""
    env.action_space.seed(action_seed)
    told: list[Any] = [digest(env.reset(seed=seed))]
    while True:
        outcome = env.step(env.action_space.sample())
        told.append(digest(outcome))
        if outcome[2] or outcome[3]:
            return told


@pytest.mark.parametrize("track", TRACK_NAMES)
def test_every_track_passes_gymnasiums_own_test(track: str) -> None:
    sensors = {"depth": {"width": 4, "height": 3}, "nearby_supplies": {}, "visible_agents": {}, "zone": {}}
    env = gymnasium.make(env_id(track), **options(track, sensors=sensors))
    check_env(env.unwrapped, skip_render_check=True)
    env.close()


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("track", ["navigation", "battle"])
def test_every_action_mode_passes_gymnasiums_own_test(track: str, mode: str) -> None:
    env = gymnasium.make(env_id(track), **options(track, sensors={}, action_mode=mode))
    check_env(env.unwrapped, skip_render_check=True)


@pytest.mark.parametrize("sensor", SENSORS)
def test_every_sensor_passes_gymnasiums_own_test(sensor: str) -> None:
    chosen = {sensor: TINY.get(sensor, {})}
    if sensor in {"segmentation", "normals"}:
        chosen = {sensor: TINY["depth"]}
    env = gymnasium.make(env_id("battle"), **options("battle", sensors=chosen))
    check_env(env.unwrapped, skip_render_check=True)


@pytest.mark.parametrize("track", TRACK_NAMES)
def test_an_episode_is_a_function_of_its_seed(track: str) -> None:
    one, other = (SingleEnv(track, **options(track, action_mode="multidiscrete")) for _ in range(2))
    first = played(one, 5)
    assert played(other, 5) == first
    assert played(one, 5) == first  # also in an environment that has played before
    assert played(one, 6) != first


@pytest.mark.parametrize("track", TRACK_NAMES)
def test_infos_have_one_structure_and_the_last_one_has_the_metrics(track: str) -> None:
    env = SingleEnv(track, **options(track, sensors={}))
    env.action_space.seed(1)
    _, info = env.reset(seed=2)
    metrics = [metric.name for metric in TRACKS[track].metrics]
    while True:
        assert list(info["events"]) == list(EVENTS)
        assert list(info["reward_terms"]) == list(TRACKS[track].rewards)
        assert list(info["metrics"]) == metrics
        _, reward, terminated, truncated, info = env.step(env.action_space.sample())
        assert reward == pytest.approx(sum(info["reward_terms"].values()))
        if terminated or truncated:
            break
    assert info["metrics"] == env.arena.measure(0, 0)


def test_time_that_is_up_truncates_and_a_target_that_is_reached_terminates_and_pays_one() -> None:
    near = options("navigation", sensors={}, map=OPEN, start=(0.0, 0.0, 0.0), target=(0.0, 0.0, 4.0))
    env = SingleEnv("navigation", **near, action_mode="baseline")
    env.reset(seed=0)
    outcomes = [env.step(1)]  # north at 6 m/s
    while not (outcomes[-1][2] or outcomes[-1][3]):
        outcomes.append(env.step(1))
    assert outcomes[-1][1:4] == (1.0, True, False)
    env.reset(seed=0)
    still = [env.step(3) for _ in range(15)]  # east, past it
    assert [outcome[2:4] for outcome in still] == [(False, False)] * 14 + [(False, True)]
    with pytest.raises(RuntimeError, match="reset"):
        env.step(0)


@pytest.mark.parametrize(("split", "odd"), [("train", 0), ("test", 1)])
def test_train_and_test_episodes_share_neither_seeds_nor_maps(split: str, odd: int) -> None:
    env = SingleEnv("navigation", map=SMALL.config, split=split, random_maps=2, sensors={})
    plan = Plan(env.config)
    specs = [Episodes(3, number).next(plan).spec for number in range(8)]
    assert {spec.seed % 2 for spec in specs} == {spec.map.seed % 2 for spec in specs} == {odd}
    assert (len({spec.seed for spec in specs}), len({spec.map.seed for spec in specs})) == (8, 2)


@pytest.mark.parametrize(
    ("split", "unseen", "pieces"),
    [("train", True, "seen"), ("test", True, "unseen"), ("train", False, "all"), ("test", False, "all")],
)
def test_pieces_of_maps_for_testing_are_unseen_in_training_if_wished(
    split: str, unseen: bool, pieces: str
) -> None:
    env = SingleEnv("navigation", map=SMALL.config, split=split, unseen=unseen, random_maps=2, sensors={})
    env.reset(seed=1)
    assert batch_of(env).specs[0].map.config.pieces == pieces


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        *(({"unseen": True, "map": fixed}, "but map names fixed maps") for fixed in (104, (104, 105), SMALL)),
        ({"unseen": True, "map": OPEN.config}, "the map config has no houses and no towns"),
        (
            {"unseen": True, "map": SEEN},
            "but the map config chooses the pieces itself: 'seen'",
        ),
        ({"sensors": {"sonar": {}}}, "there is no sensor 'sonar'"),
        ({"rewards": {"luck": 1.0}}, "there is no reward term 'luck'"),
        (
            {"action_mode": "piano"},
            "action_mode: Input should be 'dict', 'box', 'baseline', 'multidiscr",
        ),
        ({"opponents": ("hunter",)}, "opponents.0: there is no robot 'hunter'"),
        ({"opponents": ("walker", "figther")}, r"opponents.1: .* 'figther' \(did you mean 'fighter'"),
        ({"opponents": "fighter"}, "opponents: 'fighter' is not a list with an entry for each seat"),
        ({"opponents": ("agents/hunter",)}, r"given as wildscav_training\.opponents.submission"),
        ({"map": 1000}, "maps have the ids 1 to 999"),
        ({"preset": "paper-capture"}, "preset 'paper-capture' is for the track 'capture', not for 'navig"),
        ({"preset": ["a"]}, r"^preset is \['a'\]; the presets are paper-navigation"),
        ({"agents": 2}, "must be 1; use parallel_env"),
        ({"rules": "unfair"}, "rules: no rules are called 'unfair'; allowed are original, fair"),
    ],
)
def test_wrong_options_are_refused_in_one_line(wrong: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message) as raised:
        SingleEnv("navigation", **wrong)
    assert "\n" not in str(raised.value)


def test_who_sees_pixels_alone_gets_no_lists() -> None:
    rules = {"senses": "pixels"}
    env = SingleEnv("battle", map=SMALL, rules=rules, opponents=("fighter",) * 3)
    observation, _ = env.reset(seed=1)
    assert "depth" in observation
    assert not {"visible_agents", "nearby_supplies"} & set(observation)
    for _ in range(20):
        observation, *_ = env.step(env.action_space.sample())
        assert not observation["to_box"].any()
        assert not observation["to_enemy"].any()
    with pytest.raises(ValueError, match=r"sensors\.sights lists what is in sight, which the senses"):
        SingleEnv("battle", map=SMALL, rules=rules, sensors={"sights": {}, "teammates": {}, "depth": {}})


def test_an_unknown_option_is_refused_as_python_refuses_unknown_arguments() -> None:
    """TorchRL tells by the kind of the error, and by these words, that it may leave an argument out."""
    with pytest.raises(
        TypeError, match=r"^unexpected keyword argument 'time'.*; the options are preset, map"
    ):
        SingleEnv("navigation", time=3)


def test_an_episode_can_be_put_elsewhere() -> None:
    env = SingleEnv("navigation", **options("navigation", sensors={}))
    observation, _ = env.reset(seed=1, options={"start": (1.0, 30.0, 2.0), "target": (3.0, 0.0, 8.0)})
    assert observation["position"][[0, 2]].tolist() == [1, 2]
    assert observation["target"][[1, 3]].tolist() == [3, 8]
    assert env.reset()[0]["position"][[0, 2]].tolist() != [1, 2]  # for one episode only


def test_the_paper_presets_hold_an_action_for_15_frames_and_play_its_matches() -> None:
    env = SingleEnv("gathering", preset="paper-gathering")
    spec = env.arena.template
    assert (spec.frames_per_action, spec.step_limit, spec.team_of_seats) == (15, 600, (0, 0, 0, 0))
    assert (len(env.arena.pool), env.config.map) == (1, 101)
    assert SingleEnv("navigation", preset="paper-navigation").arena.template.step_limit == 400
    spec = SingleEnv("capture", preset="paper-capture").arena.template
    assert (spec.step_limit, spec.team_of_seats) == (400, (0, 0, 0, 0))


def test_a_ladder_has_the_company_of_a_level() -> None:
    config = SingleEnv("battle", preset="ladder-battle", level="brutal").config
    assert config.seats == ("submission", *("fighter",) * 9)
    assert (config.rules.bounty, config.time_limit) == (20, 120.0)
    assert SingleEnv("gathering", preset="ladder-gathering", level="easy").config.seats == ("submission",)
    newer = SingleEnv("battle", preset="ladder-battle-v2", level="brutal").config
    assert newer.seats == ("submission", *("gatherer-easy",) * 6, *("fighter-easy",) * 3)
    assert newer.rules == config.rules
    with pytest.raises(ValueError, match=r"^level: Input should be"):
        SingleEnv("battle", preset="ladder-battle", level="hardest")


def test_a_picture_a_depth_map_and_a_view_from_above() -> None:
    looks = {"render_size": (32, 18)}
    for mode, shape, dtype in (("rgb_array", (18, 32, 3), np.uint8), ("depth_array", (18, 32), np.float32)):
        env = SingleEnv(
            "battle",
            **options("battle", sensors={}, map=OPEN, start=(0.0, 0.0, -15.0), render_mode=mode, **looks),
        )
        env.reset(seed=0)
        picture = env.render()
        assert (picture.shape, picture.dtype) == (shape, dtype)
        assert picture.min() != picture.max()
    above = SingleEnv(
        "battle", **options("battle", sensors={}, render_mode="rgb_array", render_view="top", **looks)
    )
    above.reset(seed=0)
    assert above.render().std() > 5.0


def test_the_view_from_above_marks_agents_in_the_colours_of_their_teams_where_they_look() -> None:
    starts = ((0.0, 0.0, 0.0), (10.0, 0.0, 10.0), (-15.0, 0.0, -5.0))
    env = SingleEnv(
        "battle",
        **options("battle", sensors={}, map=OPEN, starts=starts, render_mode="rgb_array", render_view="top"),
    )
    env.reset(seed=0)
    agents = batch_of(env).state.agents
    agents.yaw[0, 0] = 90.0
    picture = env.render()
    middles = []
    for team in range(3):
        rows, columns = np.nonzero((picture == of_seat(team)).all(axis=2))
        assert len(rows) > 20
        middles.append((columns.mean(), rows.mean()))
    (x, y), (east, north), (west, south) = middles
    assert abs(x - 160) < 3
    assert abs(y - 90) < 3
    assert east > x > west
    assert north < y < south
    rows, columns = np.nonzero((picture == of_seat(0)).all(axis=2))
    tip, back = rows[columns > 162], rows[columns < 158]
    assert np.ptp(tip) < np.ptp(back)  # it is pointed in the east and wide in the west
    agents.health[0, 1] = 0
    assert not (env.render() == of_seat(1)).all(axis=2).any()


def test_editors_know_every_option() -> None:
    assert EnvOptions.__annotations__.keys() == EnvConfig.model_fields.keys() - {"track"} | {"preset"}


def test_environments_check_by_themselves_that_they_were_reset() -> None:
    env = gymnasium.make(env_id("navigation"), **options("navigation", action_mode="box"))
    assert env is env.unwrapped
    with pytest.raises(RuntimeError, match="reset the environment first"):
        env.step(env.action_space.sample())
