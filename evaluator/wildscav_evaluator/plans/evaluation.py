"""Evaluations: the jobs for all submissions and tracks, and the results that they add up to."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from wildscav.errors import UserError
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.output import results
from wildscav_evaluator.output.identity import Entrant, Identity, digest_of
from wildscav_evaluator.output.results import metric_infos
from wildscav_evaluator.plans.plan import Plan, evaluation_of
from wildscav_evaluator.scores.overall import overall_of
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.suites.suite import matches_in_rounds


@dataclass(frozen=True, kw_only=True)
class EvaluationPlan(Plan):
    """The plan of an evaluation: every submission plays the same suite, by itself."""

    tracks: tuple[str, ...]  # a submission plays those that its manifest names

    @property
    def title(self) -> str:
        """A short description of what is evaluated."""
        return f"{self.matches_of} · seed {self.seed.label} · sandbox {self.sandbox}"

    def entries(self) -> Iterator[tuple[str, Submission]]:
        """Yield every track with every submission that plays it."""
        for track in self.tracks:
            for submission in self.submissions:
                if track in submission.manifest.tracks:
                    yield track, submission

    def matches(self, track: str) -> tuple[MatchSpec, ...]:
        """Return the matches that every submission plays on a track."""
        return matches_in_rounds(self.suite, track, self.seed.value, self.rounds)

    def make_jobs(self) -> list[Job]:
        """Return the matches to play, sorted by map, so that a map is rarely generated twice."""
        check_names(self.submissions)
        jobs = []
        for track in self.tracks:
            playing = [submission for on, submission in self.entries() if on == track]
            for index, spec in enumerate(self.matches(track)):
                jobs += [self._job(one, track, index, spec) for one in playing]
        return jobs

    def _job(self, submission: Submission, track: str, index: int, spec: MatchSpec) -> Job:
        return Job.of_one(
            submission,
            track,
            index,
            spec,
            self.out,
            replay=self.is_rendered(index),
            sandbox=self.sandbox,
            limits=self.limits(track),
            model=self.model,
            seeds=self.seed.private(spec, [submission.digest] * spec.seats.count(SUBMISSION)),
        )

    def identity(self) -> Identity:
        """Return everything that the results depend on."""
        specs = [spec for track in self.tracks for spec in self.matches(track)]
        return Identity(
            **self.conditions(self.tracks),
            seed=self.seed.label,
            tracks=self.tracks,
            matches=digest_of(specs),
            submissions=tuple(
                Entrant.about(
                    one,
                    version=one.manifest.version,
                    tracks=tuple(track for track in self.tracks if track in one.manifest.tracks),
                )
                for one in self.submissions
            ),
        )

    def collect(self, done: Iterable[JobResult]) -> results.Results:
        """Return the results of all matches; the order in which they were played does not matter."""
        # In the order of the suite.
        done = sorted(done, key=lambda one: (one.job.track, str(one.job.evaluated), one.job.index))
        evaluations = tuple(self._evaluation(track, one, done) for track, one in self.entries())
        return results.Results(
            **self.conditions(self.tracks),
            seed=None if self.seed.commitment else self.seed.value,
            evaluations=evaluations,
            overall=overall_of(self.suite, evaluations),
            timings=self.timings(done),
        )

    def _evaluation(
        self, track: str, submission: Submission, done: Iterable[JobResult]
    ) -> results.Evaluation:
        rows = [one.row for one in done if one.job.track == track and one.job.evaluated == submission.name]
        metrics = metric_infos(track, self.matches(track)[0].metrics)
        return evaluation_of(submission, submission.manifest.version, track, metrics, rows)


def check_names(submissions: Iterable[Submission]) -> None:
    """Refuse two submissions with one name, because their records and results could not be distinguished."""
    folders: dict[str, Path] = {}
    for submission in submissions:
        if folders.get(submission.name) == submission.folder:
            raise UserError(f"submission {submission.name!r} is named twice", exit_code=2)
        if submission.name in folders:
            raise UserError(
                f"two submissions are called {submission.name!r}: {folders[submission.name]} and "
                f"{submission.folder}; change the name in one submission.toml, or evaluate them one by one",
                exit_code=2,
            )
        folders[submission.name] = submission.folder
