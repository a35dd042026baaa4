"""Presets and hyperparameters: the paper's numbers, and one clear line for what is wrong."""

import json
from typing import Any

import pytest

from wildscav.errors import UserError
from wildscav_engine.envs.batched import multi_agent_config
from wildscav_engine.tracks import TRACKS
from wildscav_training.learning.settings import (
    PAPER,
    Hyperparameters,
    TrainingSettings,
    changed,
    preset_settings,
)


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


@pytest.mark.parametrize("track", ["navigation", "gathering", "capture"])
def test_the_paper_preset_has_the_papers_environment(track: str) -> None:
    _, options = preset_settings("paper", track, {"map": 101})
    config = multi_agent_config(track, options)
    assert (config.map, config.frames_per_action, config.action_mode) == (101, 15, "baseline")
    assert config.agents == (1 if track == "navigation" else 4)


@pytest.mark.parametrize(
    ("preset", "track", "says"),
    [
        (
            "tunned",
            "navigation",
            "--preset is 'tunned' (did you mean 'tuned'?); the presets are tuned, paper",
        ),
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
