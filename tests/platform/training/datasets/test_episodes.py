"""Episodes of data sets are those of the environments: the same actions give them again, bit for bit."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.engine.envs.common import digest, many_options, options
from tests.platform.training.datasets.common import at, write_keys, write_match

from wildscav.agent import ACTION_FIELDS
from wildscav.errors import UserError
from wildscav_engine.envs import SingleEnv
from wildscav_engine.envs.batched import multi_agent_config
from wildscav_engine.envs.parallel import parallel_env
from wildscav_engine.envs.settings.config import read_config
from wildscav_engine.envs.settings.episodes import Episodes, Plan
from wildscav_engine.record import read_record, save, write_record
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import no_actions
from wildscav_stage.playing.inputs import Controls, Input
from wildscav_training.datasets.episodes import Episode
from wildscav_training.datasets.from_agent import PlayedEpisodes
from wildscav_training.datasets.from_records import RecordedEpisodes


def check_again(episode: Episode, track: str, given: dict[str, Any], seed: int) -> None:
    """Play the actions of an episode in an environment for one learner."""
    env = SingleEnv(track, **given)
    observation, _ = env.reset(seed=seed)
    assert digest(observation) == digest(at(episode.observations, 0))
    for step, reward in enumerate(episode.rewards):
        observation, got, terminated, truncated, _ = env.step(at(episode.actions, step))
        assert digest(observation) == digest(at(episode.observations, step + 1))
        assert (got, terminated, truncated) == (
            reward,
            episode.terminations[step],
            episode.truncations[step],
        )
    assert terminated or truncated


@pytest.mark.parametrize("track", ["navigation", "gathering", "battle"])
def test_a_record_gives_the_episode_that_the_environment_plays(tmp_path: Path, track: str) -> None:
    given = options(track, version=1)
    write_match(tmp_path / "a.wsr", read_config(track, given), seed=4)
    source = RecordedEpisodes([tmp_path / "a.wsr"], {})
    ((episode,),) = source
    check_again(episode, track, given, seed=4)
    assert source.spaces.observation.contains(at(episode.observations, 0))
    assert source.spaces.action.contains(at(episode.actions, 0))
    assert episode.about["agent"] == "agent 0"
    assert episode.about["seat"] == 0


def test_observations_have_the_form_that_is_asked_for(tmp_path: Path) -> None:
    write_match(tmp_path / "a.wsr", read_config("battle", options("battle")), seed=4)
    asked = {
        "flat": True,
        "version": 0,
        "action_mode": "multidiscrete",
        "sensors": {"lidar": {"azimuths": 8}},
    }
    ((episode,),) = RecordedEpisodes([tmp_path / "a.wsr"], asked)
    env = SingleEnv("battle", **options("battle", **asked))
    assert digest(env.reset(seed=4)[0]) == digest(episode.observations[0])
    assert env.action_space.contains(episode.actions[0])


@pytest.mark.parametrize("rules", ["original", "fair"])
def test_a_record_of_keys_gives_the_keys_and_what_was_seen(tmp_path: Path, rules: str) -> None:
    form: dict[str, Any] = {"action_mode": "keys", "sensors": {"camera": {"width": 16, "height": 9}}}
    given = options("battle", version=1, rules=rules, **form)
    held = write_keys(tmp_path / "a.wsr", read_config("battle", given), seed=4)
    ((episode,),) = RecordedEpisodes([tmp_path / "a.wsr"], form)
    check_again(episode, "battle", given, seed=4)
    most = 9000 if rules == "original" else 1800
    moved = np.rint([keys["mouse_x"] for keys in held]).clip(-most, most)
    np.testing.assert_array_equal(episode.actions["mouse_x"], moved)
    np.testing.assert_array_equal(episode.actions["shoot"], [keys["shoot"] for keys in held])


def test_a_persons_record_gives_data_of_the_same_form(tmp_path: Path) -> None:
    given = options("battle", frames_per_action=1, time_limit=1.0, rules="fair")
    episode = Episodes(4).next(Plan(read_config("battle", given)))
    match, controls = Match(episode.spec, episode.game_map), Controls()
    while not match.over:
        held = {"forward": -1.0, "right": 1.0, "turn": 9.331, "look": -0.4331, "shoot": True}
        controls.receive(Input(kind="input", number=match.step_number + 1, **held))
        action = controls.take(float(match.state.agents.yaw[0, 0]), 1, episode.spec.rules.turn_speed)
        rows = no_actions(match.seats)
        rows[0] = [getattr(action, name) for name in ACTION_FIELDS]
        match.step(rows)
    write_record(tmp_path / "a.wsr", match, ["person", *["robot"] * (match.seats - 1)])
    form = {"action_mode": "keys", "sensors": {"screen": {"width": 16, "height": 9}}}
    ((found,),) = RecordedEpisodes([tmp_path / "a.wsr"], form)
    assert found.observations["screen"].shape == (51, 9, 16, 3)
    assert (found.actions["back"] & found.actions["right"] & found.actions["shoot"]).all()
    assert (found.actions["mouse_x"] == 360.0).all()  # 7.2° in a frame
    assert found.actions["mouse_y"].sum() == -1083.0  # 21.655 counts a step, in whole ones


def test_a_record_without_keys_gives_none(tmp_path: Path) -> None:
    write_match(tmp_path / "a.wsr", read_config("battle", options("battle")), seed=4)
    with pytest.raises(UserError, match=r"a.wsr: step 1: the agent did not play by keys"):
        list(RecordedEpisodes([tmp_path / "a.wsr"], {"action_mode": "keys"}))


def test_an_agent_plays_the_episodes_of_the_environment() -> None:
    given = options("navigation", version=1, time_limit=4.0)
    source = PlayedEpisodes("homing", "navigation", given, matches=2, seed=7)
    for number, (episode,) in enumerate(source):
        check_again(episode, "navigation", given, seed=7 + number)
        assert (episode.about["agent"], episode.about["env_seed"]) == ("homing", 7 + number)
        assert set(episode.about["metrics"]) >= {"success", "time", "spl"}


def test_a_team_has_one_episode_with_the_rewards_of_all() -> None:
    given = many_options("gathering", version=1, teams=(0, 0, 0))
    ((episode,),) = PlayedEpisodes("homing", "gathering", given, matches=1, seed=2, together=True)
    env = parallel_env("gathering", **given)
    observations, _ = env.reset(seed=2)
    assert digest(observations) == digest(at(episode.observations, 0))
    for step in range(len(episode.rewards)):
        observations, rewards, *_ = env.step(at(episode.actions, step))
        assert digest(observations) == digest(at(episode.observations, step + 1))
        assert episode.rewards[step] == sum(rewards.values())
        assert episode.infos is not None
        assert {name: row[step + 1] for name, row in episode.infos["rewards"].items()} == rewards
    assert not env.agents
    assert episode.truncations.tolist() == [False] * (len(episode.rewards) - 1) + [True]
    assert not episode.terminations.any()


def test_who_is_out_early_has_a_shorter_episode(tmp_path: Path) -> None:
    shrinking = {"wait": 0.0, "shrink": 4.0, "share": 0.0, "damage": 200}
    given = many_options("royale", time_limit=20.0, zone={"phases": [shrinking]})
    config = multi_agent_config("royale", given)
    match = write_match(tmp_path / "a.wsr", config, seed=4)
    (episodes,) = RecordedEpisodes([tmp_path / "a.wsr"], {})
    lengths = [len(episode.rewards) for episode in episodes]
    assert len(set(lengths)) > 1
    assert max(lengths) == match.step_number
    for episode in episodes:
        ends = episode.terminations | episode.truncations
        assert ends.tolist() == [False] * (len(ends) - 1) + [True]


@pytest.mark.parametrize(
    ("choice", "seats"),
    [({}, [0, 1, 2]), ({"seats": (2, 0)}, [0, 2]), ({"names": ("b",)}, [1]), ({"names": ("a",)}, [0, 2])],
)
def test_seats_are_chosen_by_number_or_by_name(tmp_path: Path, choice: Any, seats: list[int]) -> None:
    config = multi_agent_config("battle", many_options("battle"))
    match = write_match(tmp_path / "a.wsr", config, seed=4, names=("a", "b", "a"))
    (episodes,) = RecordedEpisodes([tmp_path / "a.wsr"], {}, **choice)
    assert [episode.about["seat"] for episode in episodes] == seats
    for episode in episodes:
        assert len(episode.rewards) == match.step_number
        assert episode.about["metrics"] == match.result().seats[episode.about["seat"]].metrics


def test_robots_are_no_submissions_but_can_be_chosen(tmp_path: Path) -> None:
    write_match(tmp_path / "a.wsr", read_config("battle", options("battle")), seed=4)
    (episodes,) = RecordedEpisodes([tmp_path / "a.wsr"], {})
    assert [episode.about["seat"] for episode in episodes] == [0]
    (episodes,) = RecordedEpisodes([tmp_path / "a.wsr"], {}, seats=[1])
    assert [episode.about["seat"] for episode in episodes] == [1]
    assert np.ptp(episodes[0].observations["position"], axis=0).max() > 0.0


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ({"options": {"level": "easy"}}, "level is decided by the records; to choose are version, flat"),
        ({"options": {"flat": 3}}, "the options of the environment: flat"),
        ({"seats": [9]}, "has no seat 9; its seats are 0 to 2"),
        ({"names": ["x"]}, "has no seat named x; choose with --seat, or --name among agent 0, agent 1"),
    ],
)
def test_what_a_record_cannot_give_is_said(tmp_path: Path, arguments: Any, says: str) -> None:
    write_match(tmp_path / "a.wsr", read_config("battle", options("battle")), seed=4)
    with pytest.raises(UserError) as caught:
        RecordedEpisodes([tmp_path / "a.wsr"], **{"options": {}, **arguments})
    assert says in str(caught.value)


def test_records_of_other_kinds_do_not_mix(tmp_path: Path) -> None:
    paths = [tmp_path / f"{name}.wsr" for name in ("a", "b", "c")]
    write_match(paths[0], read_config("battle", options("battle")), seed=4)
    write_match(paths[1], read_config("navigation", options("navigation")), seed=4)
    write_match(paths[2], read_config("battle", options("battle", frames_per_action=10)), seed=4)
    for other, says in ((paths[1], "has track navigation, but"), (paths[2], "has frames_per_action 10")):
        with pytest.raises(UserError, match=says):
            list(RecordedEpisodes([paths[0], other], {}))


def test_a_record_that_does_not_hold_gives_no_episodes(tmp_path: Path) -> None:
    write_match(tmp_path / "a.wsr", read_config("navigation", options("navigation")), seed=4)
    record = read_record(tmp_path / "a.wsr")
    actions = record.actions.copy()
    actions[3, 0, 0] += 90.0
    save(replace(record, actions=actions), tmp_path / "b.wsr")
    with pytest.raises(UserError, match="does not hold: step 4 differs"):
        list(RecordedEpisodes([tmp_path / "b.wsr"], {}))
    save(replace(record, simulation_version=1), tmp_path / "c.wsr")
    with pytest.raises(UserError, match="was played with simulation version 1, but this engine has"):
        list(RecordedEpisodes([tmp_path / "c.wsr"], {}))


@pytest.mark.parametrize(
    ("agent", "track", "given", "says"),
    [
        ("nobody", "navigation", {}, "submission nobody does not exist"),
        ("mapper", "battle", {}, "the submission mapper plays navigation, not battle"),
        ("oracle", "battle", {}, "the oracle plays navigation and capture, not battle"),
        ("homing", "navigation", {"leve": "easy"}, "unexpected keyword argument 'leve'"),
    ],
)
def test_an_agent_that_cannot_play_is_said(agent: str, track: str, given: Any, says: str) -> None:
    with pytest.raises(UserError) as caught:
        PlayedEpisodes(agent, track, given, matches=1)
    assert says in str(caught.value)
