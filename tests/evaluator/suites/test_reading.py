"""The suite ``reading``: the same short matches for readers, people and programs."""

import json
import statistics
from pathlib import Path

import pytest

from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.rules import Senses
from wildscav_evaluator.scores.compare import FEWEST_PAIRS
from wildscav_evaluator.suites.reading import READING
from wildscav_evaluator.suites.suite import Reference

PLAYED = json.loads((Path(__file__).parents[3] / "benchmarks/results/reading.json").read_text())
SPECS = [spec for track in READING.tracks for seed in range(2) for spec in READING.matches(track, seed)]


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: f"{spec.track} {spec.seed}")
def test_every_match_is_short_and_can_be_played_by_words_and_by_people(spec: MatchSpec) -> None:
    assert spec.clock == "paused"
    assert 60.0 <= spec.time_limit <= 180.0
    assert spec.map.config.size <= 200
    assert spec.rules.senses == int(Senses.SIGHTED)
    assert spec.seats[0] == SUBMISSION, "a person's page has the first seat"
    assert spec.seats.count(SUBMISSION) == 1


def test_each_track_has_enough_matches_to_tell_two_submissions_apart() -> None:
    assert {len(READING.matches(track, 0)) for track in READING.tracks} == {FEWEST_PAIRS}


@pytest.mark.parametrize("track", READING.tracks)
def test_the_scale_is_what_its_agents_reached(track: str) -> None:
    """A scale that changes needs another name of the suite."""
    reference = READING.references[track]
    zero, one = (statistics.fmean(PLAYED["scores"][name][track]) for name in ("random", reference.agent))

    assert (reference.zero, reference.one) == (round(zero, 2), round(one, 2))
    assert (reference.normalized(reference.zero), reference.normalized(reference.one)) == (0.0, 1.0)


@pytest.mark.parametrize("track", READING.tracks)
def test_in_the_matches_on_file_the_reader_decided_at_most_60_times(track: str) -> None:
    assert max(PLAYED["decisions"][track]) <= 60


@pytest.mark.parametrize(
    ("score", "normalized"),
    [
        (130.0, 0.0),  # as random
        (30.0, 1.0),  # as the reference
        (80.0, 0.5),  # half way
        (10.0, 1.2),  # faster than the reference
        (140.0, -0.1),  # slower than random
    ],
)
def test_less_time_is_a_higher_normalized_score(score: float, normalized: float) -> None:
    assert Reference("mapper", zero=130.0, one=30.0).normalized(score) == pytest.approx(normalized)
