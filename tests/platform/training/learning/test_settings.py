"""Presets, hyperparameters and opponents: the paper's numbers, and one clear line for what is wrong."""

import json
from typing import Any

import pytest
from tests.platform.training.learning.common import small

from wildscav.errors import UserError
from wildscav_engine.envs import describe
from wildscav_engine.envs.batched import multi_agent_config
from wildscav_engine.tracks import TRACKS
from wildscav_training.learning.environment import make_env
from wildscav_training.learning.opposition import Opposition, fixed_opponents, read_opposition
from wildscav_training.learning.settings import (
    PAPER,
    Hyperparameters,
    TrainingSettings,
    changed,
    preset_settings,
)
from wildscav_training.opponents import SubmissionOpponent


def test_the_preset_paper_has_the_numbers_of_the_papers_table() -> None:
    paper, _ = preset_settings("paper", "navigation", {})
    assert paper == PAPER
    assert paper.learning_rate == 1e-5
    assert paper.matches * paper.rollout == 32_000
    assert (paper.minibatch, paper.rollout) == (256, 400)
    assert (paper.entropy, paper.value, paper.kl_coeff) == (0.0, 1.0, 0.2)
    assert paper.layers == (256, 256)


@pytest.mark.parametrize("track", TRACKS)
def test_every_track_has_an_environment_of_the_tuned_preset(track: str) -> None:
    _, options = preset_settings("tuned", track, {"level": "easy"})
    config = multi_agent_config(track, options)
    assert (config.version, config.flat, config.action_mode) == (1, True, "multidiscrete")
    assert config.agents == (4 if track in {"gathering", "capture"} else 1)
    assert len(config.players) == (9 if track in {"battle", "royale"} else 0)


@pytest.mark.parametrize(
    ("track", "others"), [("gathering", ("gatherer-hard",) * 29), ("battle", ("fighter-hard",) * 19)]
)
def test_on_a_ladder_one_policy_learns_among_the_robots_of_the_level(
    track: str, others: tuple[str, ...]
) -> None:
    _, options = preset_settings("tuned", track, {"preset": f"ladder-{track}", "level": "expert"})
    assert multi_agent_config(track, options).seats == ("submission", *others)


@pytest.mark.parametrize("preset", ["tuned", "paper"])
@pytest.mark.parametrize(
    ("given", "seats", "teams"),
    [
        ({}, 0, (0, 0, 0, 0)),
        ({"agents": 2}, 0, (0, 0)),
        ({"teammates": ["gatherer"]}, 0, (0, 0, 0, 0, 0)),
        ({"agents": 2, "opponents": ["gatherer"] * 2}, 0, (0, 0, 1, 2)),
        ({}, 3, (0, 0, 0, 0, 1, 2, 3)),
        ({"agents": 2, "teams": [0, 1]}, 2, (0, 1, 2, 3)),
        ({"agents": 2, "teams": None}, 2, None),
    ],
)
def test_gatherers_form_a_team_of_any_size_against_any_company(
    preset: str, given: dict[str, Any], seats: int, teams: tuple[int, ...] | None
) -> None:
    hyperparameters, options = preset_settings(preset, "gathering", {"map": 101, **given})
    assert describe(multi_agent_config("gathering", options)), "what a submission has, without opposition"
    opposition = Opposition(("self", "gatherer"), seats) if seats else None
    settings = TrainingSettings("gathering", options, 1, 0, hyperparameters, opposition=opposition)
    assert make_env(settings, 1, None).config.teams == teams


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"agents": "many"}, "agents: "),
        ({"preset": ["a"]}, r"preset is \['a'\]; the presets are paper-navigation"),
    ],
)
def test_a_wrong_option_is_said(options: dict[str, Any], says: str) -> None:
    with pytest.raises(UserError, match=f"^the options of the environment: {says}"):
        preset_settings("tuned", "gathering", options)


@pytest.mark.parametrize("track", ["navigation", "gathering", "capture"])
def test_the_paper_preset_has_the_papers_environment(track: str) -> None:
    _, options = preset_settings("paper", track, {"map": 101})
    config = multi_agent_config(track, options)
    assert (config.map, config.frames_per_action, config.action_mode) == (101, 15, "baseline")
    assert config.agents == (1 if track == "navigation" else 4)


@pytest.mark.parametrize(
    ("preset", "track", "says"),
    [
        ("tunned", "navigation", "--preset is 'tunned' (did you mean 'tuned'?); the presets are tuned"),
        ("paper", "battle", "navigation, gathering, capture, not battle"),
    ],
)
def test_a_preset_that_does_not_exist_is_said(preset: str, track: str, says: str) -> None:
    with pytest.raises(UserError) as caught:
        preset_settings(preset, track, {})
    assert says in str(caught.value)


def test_hyperparameters_are_changed_by_name() -> None:
    made = changed(Hyperparameters(), {"entropy": 0, "layers": [32], "anneal": False, "minibatch": 64})
    assert made == Hyperparameters(entropy=0, layers=(32,), anneal=False, minibatch=64)


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("entropie", 0.1, "there is no 'entropie' (did you mean 'entropy'?)"),
        ("entropy", "much", "entropy is 'much', must be a number"),
        ("entropy", True, "must be a number"),
        ("entropy", float("nan"), "must be a number from 0"),
        ("gamma", 1.5, "must be a number from 0 to 1"),
        ("minibatch", 0, "must be an integer from 1"),
        ("minibatch", 2.5, "must be an integer from 1"),
        ("anneal", 1, "must be true or false"),
        ("layers", [], "must be a list of 1 to 16 widths"),
        ("layers", 64, "must be a list of 1 to 16 widths"),
    ],
)
def test_a_wrong_hyperparameter_is_said(name: str, value: Any, says: str) -> None:
    with pytest.raises(UserError) as caught:
        changed(Hyperparameters(), {name: value})
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("steps", "learners", "rollouts"),
    [(1, 1, 1), (4096, 1, 1), (4097, 1, 2), (100_000, 1, 25), (100_000, 4, 7)],
)
def test_a_run_plays_at_least_its_steps(steps: int, learners: int, rollouts: int) -> None:
    assert Hyperparameters().rollouts(steps, learners) == rollouts


def test_settings_survive_json() -> None:
    settings = TrainingSettings("navigation", {"level": "easy"}, 100, 3, Hyperparameters(), (2.0, 5.0))
    assert json.loads(json.dumps(settings.as_json())) == settings.as_json()
    assert settings.as_json()["hyperparameters"]["layers"] == [64, 64]


def test_hyperparameters_are_known_by_the_names_of_the_release_before_too() -> None:
    assert changed(Hyperparameters(), {"discount": 0.9, "trace": 0.8}).gamma == 0.9
    assert TrainingSettings("navigation", {}, 1, 0, Hyperparameters()).as_json()["hyperparameters"][
        "discount"
    ]


def read(text: str, seats: int | None = None, *, easy_first: bool = False, **options: Any) -> Opposition:
    return read_opposition(text, "battle", {"agents": 1, **options}, seats, easy_first=easy_first)


def test_robots_submissions_and_the_policy_itself_are_told_apart() -> None:
    found = read("fighter, hunter,self")
    assert found == Opposition(("fighter", "hunter", "self"), seats=9)
    assert found.plays_itself
    assert found.robots == (("fighter",),)
    assert found.submissions == ("hunter",)
    assert read("fighter", agents=4).seats == 6, "ten seats in all"
    assert read("fighter", 2, agents=4).seats == 2


@pytest.mark.parametrize(
    ("name", "levels"),
    [
        ("fighter-easy", ("fighter-easy",)),
        ("fighter", ("fighter-easy", "fighter")),
        ("fighter-hard", ("fighter-easy", "fighter", "fighter-hard")),
        ("hunter-squad", ("hunter-squad-easy", "hunter-squad")),
    ],
)
def test_a_robot_may_begin_at_the_level_easy(name: str, levels: tuple[str, ...]) -> None:
    assert read(name, easy_first=True).robots == (levels,)
    assert read(name).robots == ((name,),)


def test_a_policy_is_measured_against_everybody_but_itself() -> None:
    fighter, hunter, again = fixed_opponents(read("self,fighter-hard,hunter", 3, easy_first=True))
    assert (fighter, again) == ("fighter-hard", "fighter-hard")
    assert isinstance(hunter, SubmissionOpponent)
    assert fixed_opponents(read("self", 2)) == ["fighter", "fighter"]
    env = make_env(small("battle", opposition=read("self,walker", 2)), 2, None, split="test")
    assert env.config.seats == ("submission", "walker", "walker")


@pytest.mark.parametrize(
    ("text", "options", "says"),
    [
        ("figther", {}, "there is no 'figther'; allowed are self, the folder or name of a submission, and"),
        ("fighter,fighter", {}, "must be different names separated by commas"),
        (" , ", {}, "must be different names separated by commas"),
        ("mapper", {}, "mapper"),  # it plays navigation alone
        ("self", {"agents": 10}, "10 learners leave no seat in battle; give --opponent-seats"),
    ],
)
def test_an_opponent_that_cannot_play_is_said(text: str, options: dict[str, Any], says: str) -> None:
    with pytest.raises(UserError) as caught:
        read(text, **options)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)
