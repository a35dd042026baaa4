"""``wildscav baselines``: its table, its document, and what it refuses."""

import json

import pytest
from tests.commands import run_command

from wildscav_training.cli.baselines import _baselines_of


def test_it_shows_and_prints_what_agents_reach_on_a_level() -> None:
    done = run_command("baselines", "straight", "oracle", "--level", "easy", "--matches", 3, "--json")

    assert done.returncode == 0, done.stderr
    document = json.loads(done.stdout)
    assert (document["track"], document["matches"]) == ("navigation", 3)
    assert [(row["level"], row["agent"]) for row in document["rows"]] == [
        ("easy", "straight"),
        ("easy", "oracle"),
    ]
    oracle = document["rows"][1]["metrics"]
    assert oracle["success"] == pytest.approx({"mean": 1.0, "low": 0.438, "high": 1.0}, abs=1e-3)
    assert oracle["spl"]["low"] <= oracle["spl"]["mean"] <= oracle["spl"]["high"]
    heads = ["level", "agent", "success", "SPL", "ms", "a", "step"]
    lines = [line.split() for line in done.stderr.splitlines()]
    assert heads in lines
    assert any(line[:5] == ["easy", "oracle", "100.0", "%", "(43.8–100.0)"] for line in lines)


def test_a_track_without_a_target_has_its_own_score() -> None:
    done = run_command("baselines", "homing", "--track", "gathering", "--level", "easy", "--matches", 2)

    assert done.returncode == 0, done.stderr
    assert "supplies" in done.stdout
    assert "success" not in done.stdout


def test_by_default_all_baselines_of_the_track_play() -> None:
    names = _baselines_of("navigation")
    assert (names[0], names[-1]) == ("straight", "oracle")
    assert {"homing", "mapper", "navigator", "learned-navigator", "cloned-navigator"} < set(names)
    assert {"hunter", "commando"} < set(_baselines_of("battle")) < {*names, *_baselines_of("battle")}
    assert "oracle" not in _baselines_of("gathering")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--level", "simple"), "'simple' is not one of 'easy', 'normal', 'hard', 'tough'"),
        (("mapper", "--track", "battle"), "the submission mapper plays navigation, not battle"),
        (("oracle", "--track", "battle"), "the oracle plays navigation and capture, not battle"),
        (("maper",), "submission maper does not exist"),
    ],
)
def test_what_cannot_be_played_is_refused(arguments: tuple[str, ...], says: str) -> None:
    done = run_command("baselines", *arguments, columns=200)

    assert done.returncode == 2
    assert says in done.stderr
