"""``wildscav baselines``: its table, its document, and what it refuses."""

import json

import pytest
from tests.commands import run_command
from tests.end_to_end.pages import json_documents, names

from wildscav_training.cli.playing import baselines_of
from wildscav_training.company import scenarios


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
    told = json_documents()["baselines"] - {"scenario"}  # in place of the level of a track with robots
    assert names(document) | oracle["spl"].keys() == told
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
    names = baselines_of("navigation")
    assert (names[0], names[-1]) == ("straight", "oracle")
    assert {"homing", "mapper", "navigator", "learned-navigator", "cloned-navigator"} < set(names)
    assert {"hunter", "commando"} < set(baselines_of("battle")) < {*names, *baselines_of("battle")}
    assert "oracle" not in baselines_of("gathering")


def test_a_scenario_shows_and_prints_normalized_scores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(scenarios, "TIME_LIMIT", 6.0)
    arguments = ("commando", "homing", "--scenario", "all", "--track", "gathering", "--matches", 2, "--json")
    done = run_command("baselines", *arguments, columns=120)

    assert done.returncode == 0, done.stderr
    rows = json.loads(done.stdout)["rows"]
    told = "normalized" in rows[0]["metrics"]
    places = [("rivals", "commando"), ("rivals", "homing")]
    assert [(row["scenario"], row["agent"]) for row in rows[:2]] == places
    reference = rows[0]["metrics"]
    assert reference["score"] == reference["reference"] == rows[1]["metrics"]["reference"]
    assert len(rows) == (4 if told else 2)
    for one, mean in zip(rows[:2], rows[2:], strict=told):
        assert one["metrics"]["normalized"] == mean["metrics"]["normalized"], "there is one scenario"
    heads = ["scenario", "agent", "score", "random", "reference", "normalized", "ms", "a", "step"]
    assert heads in [line.split() for line in done.stderr.splitlines()]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--level", "simple"), "'simple' is not one of 'easy', 'normal', 'hard', 'tough'"),
        (("mapper", "--track", "battle"), "the submission mapper plays navigation, not battle"),
        (("oracle", "--track", "battle"), "the oracle plays navigation and capture, not battle"),
        (("maper",), "submission maper does not exist"),
        (("--scenario", "hunters"), "'hunters' is not one of 'rivals', 'greedy-mate', 'snipers', 'hiders'"),
        (("mapper", "--scenario", "all"), "the submission mapper plays navigation, not gathering"),
        (("survivor", "--scenario", "copies"), "the submission survivor plays royale, not battle"),
        (("--scenario", "all", "--level", "easy"), "--scenario has maps of its own; omit --level"),
        (("--scenario", "hiders", "--track", "battle"), "--track is battle, but --scenario hiders is"),
    ],
)
def test_what_cannot_be_played_is_refused(arguments: tuple[str, ...], says: str) -> None:
    done = run_command("baselines", *arguments, columns=200)

    assert done.returncode == 2
    assert says in done.stderr
