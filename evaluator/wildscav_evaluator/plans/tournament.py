"""Tournaments: the jobs of all matches among the entrants, and the results that they add up to."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from wildscav_engine.version import ENGINE_VERSION
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.output.identity import Entrant, Identity, digest_of
from wildscav_evaluator.output.results import (
    MatchRow,
    Results,
    TournamentSettings,
    metric_infos,
)
from wildscav_evaluator.plans.plan import Plan, evaluation_of
from wildscav_evaluator.seats import robot_entrant
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.tournaments.drawing import TournamentMatch, tournament_matches


@dataclass(frozen=True, kw_only=True)
class TournamentPlan(Plan):
    """The plan of a tournament: the entrants play each other on one track.

    The submissions have unique names (see ``tournaments/names.py``); their order does not matter.
    """

    track: str
    settings: TournamentSettings
    robots: tuple[str, ...] = ()  # the robots that are entrants

    @property
    def title(self) -> str:
        """A short description of what is played."""
        return (
            f"tournament of {len(self.entrants)} on {self.track} · {self.matches_of} · "
            f"seed {self.seed.label} · sandbox {self.sandbox}"
        )

    @cached_property
    def entrants(self) -> tuple[Entrant, ...]:
        """The entrants, sorted by name."""
        submissions = [
            Entrant.about(one, version=one.manifest.version, tracks=(self.track,)) for one in self.submissions
        ]
        robots = [
            Entrant(name=robot_entrant(robot), version=ENGINE_VERSION, digest="", tracks=(self.track,))
            for robot in self.robots
        ]
        return tuple(sorted(submissions + robots, key=lambda one: one.name))

    @cached_property
    def matches(self) -> tuple[TournamentMatch, ...]:
        """All matches, in the order of the schedule."""
        return tournament_matches(
            self.suite,
            self.track,
            self.seed.value,
            self.rounds,
            self.settings,
            [one.name for one in self.entrants],
        )

    def make_jobs(self) -> list[Job]:
        """Return the matches to play, in the order of the schedule, so that few maps are generated twice."""
        by_name = {one.name: one for one in self.submissions}
        return [self._job(index, match, by_name) for index, match in enumerate(self.matches)]

    def _job(self, index: int, match: TournamentMatch, by_name: dict[str, Submission]) -> Job:
        submissions = tuple(by_name[name] for name in match.submissions)
        return Job(
            submissions,
            self.track,
            index,
            match.spec,
            self.out,
            replay=self.is_rendered(index),
            sandbox=self.sandbox,
            limits=self.limits(self.track),
            model=self.model,
            robots=match.robots,
            seeds=self.seed.private(match.spec, [one.digest for one in submissions]),
        )

    def identity(self) -> Identity:
        """Return everything that the results depend on."""
        return Identity(
            **self.conditions((self.track,)),
            seed=self.seed.label,
            tracks=(self.track,),
            matches=digest_of(match.spec for match in self.matches),
            submissions=self.entrants,
            tournament=self.settings,
        )

    def collect(self, done: Iterable[JobResult]) -> Results:
        """Return the results of all matches; the order in which they were played does not matter."""
        done = sorted(done, key=lambda result: result.job.index)  # in the order of the schedule
        rows: dict[str, list[MatchRow]] = {one.name: [] for one in self.entrants}
        for result in done:
            for name, row in result.rows.items():
                rows[name].append(row)
        metrics = metric_infos(self.track, self.matches[0].spec.metrics)
        return Results(
            **self.conditions((self.track,)),
            seed=None if self.seed.commitment else self.seed.value,
            tournament=self.settings,
            evaluations=tuple(
                evaluation_of(one, one.version, self.track, metrics, rows[one.name]) for one in self.entrants
            ),
            timings=self.timings(done),
        )
