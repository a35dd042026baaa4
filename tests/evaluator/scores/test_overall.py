"""Ratings across the tracks of a suite, with numbers worked out by hand."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.evaluator.results_by_hand import MODEL, evaluation, saved, scored_results

from wildscav_engine.specs.thinking import ClockChoice
from wildscav_evaluator.cli.sessions.leaderboard import show_standings
from wildscav_evaluator.output.results import Evaluation, Overall, Results
from wildscav_evaluator.scores.audit import AuditedFolder, discrepancies
from wildscav_evaluator.scores.leaderboard import document_of_overall, overall_standings
from wildscav_evaluator.scores.overall import across_tracks, overall_of
from wildscav_evaluator.suites.reading import READING
from wildscav_evaluator.suites.suite import SUITES, Reference

# 100 s are 0 and 20 s are 1; 10 supplies are 0 and 210 are 1.
REFERENCES = {"navigation": Reference("mapper", 100.0, 20.0), "gathering": Reference("homing", 10.0, 210.0)}
SUITE = replace(SUITES["quick"], references=REFERENCES)


def overall(navigation: Sequence[float], gathering: Sequence[float], name: str = "a") -> Overall:
    """Rate a submission with these scores."""
    played = (
        evaluation(name, "navigation", tuple(navigation)),
        evaluation(name, "gathering", tuple(gathering)),
    )
    (one,) = overall_of(SUITE, played) or ()
    return one


def rated(*rows: Overall, **others: object) -> Results:
    return scored_results({("a", "navigation"): [1.0]}, **others).model_copy(update={"overall": rows})


def rated_reading() -> Results:
    """Results of a submission on all tracks of the suite that rates across them."""
    results = scored_results({("a", track): [1.0, 2.0] for track in READING.tracks}, suite="reading")
    return results.model_copy(update={"overall": overall_of(READING, results.evaluations)})


def test_the_mean_counts_every_track_alike() -> None:
    one = overall([20.0, 60.0], [10.0, 10.0, 10.0, 10.0])  # 1 and 0.5; four times 0

    assert one.tracks["navigation"].value == 0.75
    assert one.tracks["gathering"].value == 0.0
    assert one.mean.value == 0.375


def test_the_interquartile_mean_leaves_out_the_best_and_the_worst_quarter() -> None:
    _, iqm = across_tracks([[-9.0, 0.2, 0.4, 0.6], [0.2, 0.4, 0.6, 99.0]])

    assert iqm.value == pytest.approx((0.2 + 0.4 + 0.4 + 0.6) / 4)


def test_the_interval_of_a_time_is_turned_round_so_that_more_is_better() -> None:
    one = overall([20.0, 60.0, 100.0], [10.0, 20.0]).tracks["navigation"]

    assert one.low < one.value < one.high


def test_nineteen_of_twenty_intervals_hold_the_true_mean() -> None:
    dice = np.random.default_rng(1)
    samples = dice.exponential(1.0, size=(150, 5, 6)).tolist()  # as skewed as scores come
    held = [mean.low <= 1.0 <= mean.high for mean, _ in map(across_tracks, samples)]

    assert np.mean(held) > 0.88


def test_a_single_match_on_a_track_gives_no_width() -> None:
    mean, iqm = across_tracks([[0.5], [0.7, 0.9]])

    assert (mean.low, mean.high) == (mean.value, mean.value)
    assert (iqm.low, iqm.high) == (iqm.value, iqm.value)


@pytest.mark.parametrize(
    "played",
    [
        [evaluation("a", "navigation")],
        [evaluation("a", "gathering")],
        [],
        [evaluation("a", "navigation"), evaluation("a", "gathering", ())],
    ],
    ids=["navigation", "gathering", "nothing", "no result"],
)
def test_whoever_lacks_a_track_has_no_overall_rating(played: list[Evaluation]) -> None:
    assert overall_of(SUITE, played) == ()


def test_a_suite_without_a_scale_rates_nobody_and_its_results_stay_as_they_were() -> None:
    assert overall_of(SUITES["quick"], [evaluation("a", "navigation")]) is None
    assert "overall" not in scored_results({("a", "navigation"): [1.0]}).as_json()


@pytest.mark.parametrize(
    ("reported", "is_refused"),
    [
        (None, True),  # left out
        ((), True),
        (rated_reading().overall, False),
    ],
    ids=["no field", "nobody", "as the scores say"],
)
def test_ratings_that_the_scores_do_not_give_are_named(
    reported: tuple[Overall, ...] | None, is_refused: bool, tmp_path: Path
) -> None:
    recomputed = rated_reading()
    told = recomputed.model_copy(update={"overall": reported})
    folder = AuditedFolder(tmp_path, told, identity=None, ledger=None, fault="", key=None)

    lines = list(discrepancies(folder, [], recomputed))

    assert any("the ratings across tracks in results.json" in line for line in lines) == is_refused


def test_standings_across_tracks_have_the_latest_rating_of_each_submission() -> None:
    good, bad = overall([20.0], [210.0], "good"), overall([100.0], [10.0], "bad")
    better = overall([20.0], [110.0], "bad")
    results = [rated(good, bad), rated(better, started="2031-01-01T00:00:00+00:00")]

    (table,) = overall_standings(results)
    told = document_of_overall(table)

    assert [(rank, one.submission, one.mean.value) for rank, one in table.rows] == [
        (1, "good", 1.0),
        (2, "bad", 0.75),
    ]
    assert [row["iqm"]["value"] for row in told["rows"]] == [1.0, 0.75]


@pytest.mark.parametrize(
    "changed",
    [{"seed": 1}, {"suite": "other"}, {"sandbox": "oci"}, {"memory": 2**30}, {"model": MODEL}],
    ids=str,
)
def test_ratings_under_other_conditions_stand_in_another_table(changed: dict[str, object]) -> None:
    one = overall([20.0], [210.0])

    assert len(list(overall_standings([rated(one), rated(one, **changed)]))) == 2


def test_a_person_stands_beside_agents_of_the_same_name_that_could_ask_a_model(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    agents = rated(overall([20.0], [210.0]), memory=2**30, model=MODEL, clock=ClockChoice(clock="paused"))
    person = agents.model_copy(
        update={"overall": (overall([100.0], [10.0]),), "sandbox": "browser", "limits": {}, "model": None}
    )

    (table,) = overall_standings([agents, person])
    assert [(rank, one.mean.value) for rank, one in table.rows] == [(1, 1.0), (2, 0.0)]
    show_standings([saved(agents, tmp_path / "agents")])
    told = capsys.readouterr().out
    assert told.count("model: reader-7b (") == 2, "of the track, and across tracks"
    assert told.count("clock paused") == 2
