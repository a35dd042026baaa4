"""Evaluations: the jobs of all submissions and tracks, and the results that they add up to."""

import os
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from wildscav.errors import UserError
from wildscav_engine import ENGINE_VERSION
from wildscav_evaluator import results
from wildscav_evaluator.jobs import Job, JobResult
from wildscav_evaluator.score import summarize
from wildscav_evaluator.submission import Submission
from wildscav_evaluator.suites import suite
from wildscav_evaluator.workers import Workers

REPLAY_CHOICES = ("none", "first", "all")


@dataclass(frozen=True)
class Plan:
    """All that an evaluation is asked to do."""

    submissions: tuple[Submission, ...]
    tracks: tuple[str, ...]  # a submission plays those that it has, too
    suite: str
    seed: int
    replays: str  # one of REPLAY_CHOICES
    jobs: int  # matches at once
    out: Path

    def entries(self) -> Iterator[tuple[str, Submission]]:
        """Yield every track with every submission that plays it."""
        for track in self.tracks:
            for submission in self.submissions:
                if track in submission.manifest.tracks:
                    yield track, submission


def make_jobs(plan: Plan) -> list[Job]:
    """Return the matches to play; those of one map stand together, so that it is rarely made twice."""
    jobs = []
    for track in plan.tracks:
        playing = [submission for on, submission in plan.entries() if on == track]
        for index, spec in enumerate(suite(track, plan.suite, plan.seed)):
            replay = plan.replays == "all" or (plan.replays == "first" and index == 0)
            jobs += [Job(submission, track, index, spec, plan.out, replay) for submission in playing]
    return jobs


def default_jobs() -> int:
    """Return how many matches to play at once: one a processor core that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def evaluate(
    plan: Plan,
    workers: Workers,
    jobs: Sequence[Job],
    report: Callable[[JobResult], None] = lambda _: None,
) -> results.Results:
    """Play all matches and return the results.

    Args:
        plan: What is asked.
        workers: Who plays.
        jobs: The matches of the plan.
        report: Told of every match as it ends.
    """
    started, clock = datetime.now(UTC), time.perf_counter()
    done = []
    for result in workers.run(jobs):
        done.append(result)
        report(result)
    # In the order of the suite, whatever the order in which the matches ended.
    done.sort(key=lambda result: (result.job.track, result.job.submission.name, result.job.index))
    timings = results.Timings(
        started=started.isoformat(timespec="seconds"),
        wall=time.perf_counter() - clock,
        jobs=plan.jobs,
        matches=tuple(result.timing for result in done if result.timing is not None),
    )
    return results.Results(
        engine_version=ENGINE_VERSION,
        suite=plan.suite,
        seed=plan.seed,
        evaluations=tuple(_evaluation(plan, track, submission, done) for track, submission in plan.entries()),
        timings=timings,
    )


def metric_infos(track: str) -> tuple[results.MetricInfo, ...]:
    """Return what a track measures; the first is its score."""
    from wildscav_engine.tracks import TRACKS

    return tuple(results.MetricInfo(**metric._asdict()) for metric in TRACKS[track].metrics)


def _evaluation(
    plan: Plan, track: str, submission: Submission, done: Iterable[JobResult]
) -> results.Evaluation:
    rows = tuple(
        result.row
        for result in done
        if result.job.track == track and result.job.submission.name == submission.name
    )
    metrics = metric_infos(track)
    return results.Evaluation(
        submission=submission.name,
        version=submission.manifest.version,
        digest=submission.digest,
        track=track,
        metrics=metrics,
        matches=rows,
        summary=summary(metrics, rows, plan.seed),
    )


def summary(
    metrics: Iterable[results.MetricInfo], rows: Iterable[results.MatchRow], seed: int
) -> dict[str, results.Summary]:
    """Return every metric over the matches that came to a result, an agent's failures included."""
    played = [row.metrics for row in rows if row.metrics is not None]
    if not played:
        return {}
    return {metric.name: summarize([values[metric.name] for values in played], seed) for metric in metrics}


def check_names(submissions: Iterable[Submission]) -> None:
    """Refuse two submissions of one name: their records and results could not be told apart.

    Raises:
        UserError: Two have the same name.
    """
    folders: dict[str, Path] = {}
    for submission in submissions:
        if submission.name in folders:
            raise UserError(
                f"two submissions are called {submission.name!r}: {folders[submission.name]} and "
                f"{submission.folder}; change the name in one submission.toml, or evaluate them one by one",
                exit_code=2,
            )
        folders[submission.name] = submission.folder
