"""Results made by hand, without a match, and plans."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from wildscav_evaluator.output.identity import Entrant, Identity
from wildscav_evaluator.output.results import (
    CURRENT_VERSIONS,
    Evaluation,
    KeptLimits,
    MatchRow,
    MatchTiming,
    MetricInfo,
    ModelTerms,
    Results,
    SeatRow,
    SeatTiming,
    Summary,
    Timings,
    metric_infos,
    write_results,
)
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.scores.score import summary
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.suites.seeds import SuiteSeed
from wildscav_evaluator.suites.suite import SUITES

MODEL = ModelTerms(
    name="reader-7b",
    max_tokens=512,
    extra={"seed": 1},
    timeout=60.0,
    requests=100,
    tokens=500_000,
    seconds=600.0,
)


def results_of(text: str, *others: str) -> Results:
    """Results in which one submission has the text wherever there is any, beside honest ones."""
    names = (text, *others)
    timings = [
        MatchTiming(
            submission=name,
            track="navigation",
            index=0,
            started=0.0,
            wall=1.0,
            steps=5,
            seats=(timing_of_a_seat(),),
            platform_faults=(name,),
        )
        for name in names
    ]
    return Results(
        versions=CURRENT_VERSIONS,
        suite="quick",
        seed=0,
        sandbox="process",
        limits={"navigation": KeptLimits(memory=1)},
        evaluations=tuple(evaluation_of(name) for name in names),
        timings=Timings(started="2030-01-01T00:00:00+00:00", wall=1.0, jobs=1, matches=tuple(timings)),
    )


def plan_of(*submissions: Submission, out: Path, **others: Any) -> EvaluationPlan:
    """Plan of an evaluation of some submissions on navigation, without replays and one match at a time."""
    usual = {"suite": SUITES["quick"], "seed": SuiteSeed(0), "replays": "none", "jobs": 1}
    return EvaluationPlan(submissions=submissions, tracks=("navigation",), out=out, **usual | others)  # type: ignore[arg-type]


def identity_of(
    *names: str, track: str = "navigation", digest: str = "1" * 32, key: str | None = None
) -> Identity:
    """Identity of an evaluation of some submissions on one track."""
    return Identity(
        versions=CURRENT_VERSIONS,
        suite="quick",
        seed="0",
        tracks=(track,),
        matches="0" * 32,
        submissions=tuple(
            Entrant(name=name, version="1.0.0", digest=digest, tracks=(track,)) for name in names
        ),
        sandbox="process",
        limits={},
        key=key,
    )


def evaluation_of(text: str) -> Evaluation:
    seat = SeatRow(
        seat=0,
        status="crashed",
        fault="agent",
        detail=text,
        killed_by=text,
        last_lines=(text, text),
        actions=2,
        invalid_actions=1,
        metrics={"time": 1.0},
        log=text,
    )
    return Evaluation(
        submission=text,
        version=text,
        digest=text,
        track="navigation",
        metrics=(MetricInfo(name="time", title="time", unit="s", lower_is_better=True),),
        matches=(MatchRow.of(0, (seat,), text),),
        summary={"time": Summary(mean=1.0, std=None, low=1.0, high=1.0)},
    )


def timing_of_a_seat(**changes: float) -> SeatTiming:
    timing = SeatTiming(
        seat=0,
        start_up=0.5,
        steps=5,
        late_steps=1,
        time_used=1.0,
        latency_p50=0.1,
        latency_p99=0.1,
        latency_max=0.1,
        time_bank=1.0,
    )
    return timing.model_copy(update=changes)


def scored_results(scores: Mapping[tuple[str, str], Sequence[float | None]], **others: Any) -> Results:
    """Results with the score of each match of every (submission, track); without one, its match failed."""
    version, memory = others.pop("version", "1.0.0"), others.pop("memory", None)
    started = others.pop("started", "2030-01-01T00:00:00+00:00")
    made = [evaluation(name, track, tuple(values)) for (name, track), values in scores.items()]
    failed = MatchRow(index=0, status="failed", fault="platform", detail="no map")
    usual = {"versions": CURRENT_VERSIONS, "suite": "quick", "seed": 0, "sandbox": "process"}
    return Results(
        **usual | others,  # type: ignore[arg-type]
        limits={track: KeptLimits(memory=memory) for _, track in scores},
        evaluations=tuple(
            one.model_copy(update={"version": version, "matches": one.matches or (failed,)}) for one in made
        ),
        timings=Timings(started=started, wall=1.0, jobs=1, matches=()),
    )


def saved(results: Results, folder: Path) -> Path:
    """Write results into a folder, which is made, and return it."""
    folder.mkdir(parents=True)
    write_results(results, folder)
    return folder


def evaluation(name: str, track: str = "royale", values: Sequence[float | None] = (1.0, 2.0)) -> Evaluation:
    """An evaluation in whose matches every metric has one value; the platform failed in those without."""
    metrics = metric_infos(track)
    rows = tuple(
        MatchRow(index=index, status="failed", fault="platform")
        if value is None
        else MatchRow(index=index, status="finished", metrics={metric.name: value for metric in metrics})
        for index, value in enumerate(values)
    )
    return Evaluation(
        submission=name,
        version="1.0.0",
        digest=f"digest of {name}",
        track=track,
        metrics=metrics,
        matches=rows,
        summary=summary(metrics, rows),
    )


RESULTS = results_of("my-agent").model_copy(
    update={"evaluations": (evaluation("my-agent"), evaluation("homing", values=(3.0, 4.0)))}
)
