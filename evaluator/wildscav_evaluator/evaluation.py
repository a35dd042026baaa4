"""Evaluations: the jobs for all submissions and tracks, and the results that they add up to."""

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from wildscav.errors import UserError
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.ledger.keys import SigningKey
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.output import results
from wildscav_evaluator.output.identity import Entrant, Identity, digest_of
from wildscav_evaluator.output.numbered_folders import own_folder
from wildscav_evaluator.output.results import metric_infos
from wildscav_evaluator.output.versions import CURRENT_VERSIONS
from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_evaluator.sandbox.limits import DEFAULT_LIMITS, Limits
from wildscav_evaluator.scores.score import summary
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.suites.rounds import matches_in_rounds
from wildscav_evaluator.suites.seeds import SuiteSeed
from wildscav_evaluator.suites.suite import Suite

REPLAY_CHOICES = ("none", "first", "all")
KEPT_ANYWHERE = {"output", "wall_clock"}  # limits that even a sandbox without isolation enforces


@dataclass(frozen=True)
class Plan:
    """Everything that defines the run of an evaluation."""

    submissions: tuple[Submission, ...]
    tracks: tuple[str, ...]  # a submission plays those that its manifest names
    suite: Suite
    seed: SuiteSeed
    replays: str  # one of REPLAY_CHOICES
    jobs: int  # matches at once
    out: Path
    fresh: bool = False  # whether another evaluation in the output folder is removed
    rounds: int = 1  # how often the suite is played, each time with the next seed
    sandbox: str = "process"  # the name of the sandbox in which agents run
    key: SigningKey | None = None  # the key that signs the ledger

    @property
    def public_key(self) -> str | None:
        """The public half of the key, 64 hexadecimal digits."""
        return None if self.key is None else self.key.public

    @property
    def title(self) -> str:
        """A short description of what is evaluated."""
        return f"suite {self.suite.label} · seed {self.seed.label} · sandbox {self.sandbox}"

    def entries(self) -> Iterator[tuple[str, Submission]]:
        """Yield every track with every submission that plays it."""
        for track in self.tracks:
            for submission in self.submissions:
                if track in submission.manifest.tracks:
                    yield track, submission

    def matches(self, track: str) -> tuple[MatchSpec, ...]:
        """Return the matches that every submission plays on a track."""
        return matches_in_rounds(self.suite, track, self.seed.value, self.rounds)

    def limits(self, track: str) -> Limits:
        """Return the limits of an agent on a track."""
        return self.suite.limits.get(track, DEFAULT_LIMITS)

    def kept_limits(self) -> dict[str, results.KeptLimits]:
        """Return the limits that the sandbox enforces, by track."""
        kept = None if SANDBOXES[self.sandbox].isolated else KEPT_ANYWHERE
        return {
            track: results.KeptLimits(**self.limits(track).model_dump(include=kept)) for track in self.tracks
        }


def in_own_folder(plan: Plan) -> Plan:
    """Return a plan with a numbered output folder inside the plan's output folder."""
    return replace(plan, out=own_folder(plan.out, identity(plan), fresh=plan.fresh))


def make_jobs(plan: Plan) -> list[Job]:
    """Return the matches to play, sorted by map, so that a map is rarely generated twice."""
    evaluation = identity(plan).digest
    jobs = []
    for track in plan.tracks:
        playing = [submission for on, submission in plan.entries() if on == track]
        limits = plan.limits(track)
        for index, spec in enumerate(plan.matches(track)):
            replay = plan.replays == "all" or (plan.replays == "first" and index == 0)
            jobs += [
                Job(one, track, index, spec, plan.out, replay, evaluation, plan.sandbox, limits)
                for one in playing
            ]
    return jobs


def identity(plan: Plan) -> Identity:
    """Return everything that the results of a plan depend on."""
    specs = [spec for track in plan.tracks for spec in plan.matches(track)]
    return Identity(
        versions=CURRENT_VERSIONS,
        suite=plan.suite.label,
        seed=plan.seed.label,
        commitment=plan.seed.commitment,
        rounds=plan.rounds,
        tracks=plan.tracks,
        matches=digest_of(specs),
        submissions=tuple(
            Entrant(
                name=one.name,
                version=one.manifest.version,
                digest=one.digest,
                tracks=tuple(track for track in plan.tracks if track in one.manifest.tracks),
            )
            for one in plan.submissions
        ),
        sandbox=plan.sandbox,
        limits=plan.kept_limits(),
        key=plan.public_key,
    )


def collect(plan: Plan, done: Iterable[JobResult]) -> results.Results:
    """Return the results of all matches of a plan; the order in which they were played does not matter."""
    # In the order of the suite.
    done = sorted(done, key=lambda result: (result.job.track, result.job.submission.name, result.job.index))
    return results.Results(
        versions=CURRENT_VERSIONS,
        suite=plan.suite.label,
        seed=None if plan.seed.commitment else plan.seed.value,
        commitment=plan.seed.commitment,
        rounds=plan.rounds,
        sandbox=plan.sandbox,
        limits=plan.kept_limits(),
        key=plan.public_key,
        evaluations=tuple(_evaluation(plan, track, submission, done) for track, submission in plan.entries()),
        timings=_timings(plan, [result.timing for result in done if result.timing is not None]),
    )


def _timings(plan: Plan, matches: Sequence[results.MatchTiming]) -> results.Timings:
    first = min((timing.started for timing in matches), default=time.time())
    return results.Timings(
        started=datetime.fromtimestamp(first, UTC).isoformat(timespec="seconds"),
        wall=_covered((timing.started, timing.started + timing.wall) for timing in matches),
        jobs=plan.jobs,
        matches=tuple(matches),
    )


def _covered(spans: Iterable[tuple[float, float]]) -> float:
    """Return the total time that some spans of time cover, s; overlaps count once."""
    total, until = 0.0, 0.0
    for start, end in sorted(spans):
        total += max(0.0, end - max(start, until))
        until = max(until, end)
    return total


def _evaluation(
    plan: Plan, track: str, submission: Submission, done: Iterable[JobResult]
) -> results.Evaluation:
    rows = tuple(
        result.row
        for result in done
        if result.job.track == track and result.job.submission.name == submission.name
    )
    metrics = metric_infos(track, plan.matches(track)[0].metrics)
    return results.Evaluation(
        submission=submission.name,
        version=submission.manifest.version,
        digest=submission.digest,
        track=track,
        metrics=metrics,
        matches=rows,
        summary=summary(metrics, rows),
    )


def check_names(submissions: Iterable[Submission]) -> None:
    """Refuse two submissions with one name, because their records and results could not be distinguished.

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
