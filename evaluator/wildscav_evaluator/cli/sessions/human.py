"""A person who plays the matches of a suite in the browser: an evaluation whose rows stand beside agents'."""

import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from wildscav.errors import UserError
from wildscav.terminal.console import console, counted
from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_engine.storage.files import write_whole
from wildscav_evaluator.cli.options.selection import check_suite_has
from wildscav_evaluator.cli.sessions.evaluate import show_scores
from wildscav_evaluator.cli.sessions.playing import raise_errors, saving_errors, say_files
from wildscav_evaluator.ledger.writer import LedgerWriter
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.matches.play import PlayedMatch
from wildscav_evaluator.matches.run_job import match_timing, seat_row
from wildscav_evaluator.output.folder import check_out, keep_only, output_folder
from wildscav_evaluator.output.layout import SUITE_FILE
from wildscav_evaluator.output.numbered_folders import EVALUATIONS
from wildscav_evaluator.output.results import BROWSER, KeptLimits, MatchRow
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.suites.seeds import SuiteSeed
from wildscav_evaluator.suites.suite_file import find_suite
from wildscav_server.hosting.manifest import Manifest
from wildscav_server.hosting.reports import MatchOutcome
from wildscav_stage.playing.plan import Plan, given_plan


@dataclass(frozen=True, kw_only=True)
class PersonPlan(EvaluationPlan):
    """The plan of an evaluation of one person, who needs neither a sandbox nor limits."""

    def kept_limits(self, tracks: Iterable[str]) -> dict[str, KeptLimits]:  # noqa: ARG002 - of agents
        """Return no limits."""
        return {}


class PersonSession:
    """Keeps the matches of a person in an output folder, as those of a submission are kept."""

    def __init__(self, plan: PersonPlan) -> None:
        self.plan, self.jobs = plan, plan.make_jobs()
        self.ledger = LedgerWriter(plan.out, plan.identity(), plan.key)
        self.done = self.ledger.kept(self.jobs)
        keep_only(plan.out, (result.job.stem for result in self.done))

    @property
    def following(self) -> Plan | None:
        """The plan of the next match; None if all were played."""
        if len(self.done) == len(self.jobs):
            return None
        played = {result.job.stem for result in self.done}
        match = GivenMatch(self, next(job for job in self.jobs if job.stem not in played))
        return given_plan(match.job.spec, match)

    def finish(self) -> None:
        """Show the results if all matches were played, else how many are left."""
        if self.following is not None:
            all_matches = counted(len(self.jobs), "match")
            console.print(
                f"{len(self.done)} of {all_matches} are saved in {self.plan.out}; the same command goes on"
            )
            return
        results = self.plan.collect(self.done)
        errors = saving_errors(results, self.plan.out, self.ledger)
        show_scores(results)
        say_files(self.plan, self.ledger, results)
        raise_errors(errors)


class GivenMatch:
    """One match of a person's evaluation; see ``wildscav_stage.playing.plan.Given``."""

    def __init__(self, session: PersonSession, job: Job) -> None:
        self.job, self._session = job, session
        number, matches = session.jobs.index(job) + 1, len(session.jobs)
        self.title = f"{job.track}, match {number} of {matches}"
        self.names = job.seating.names
        (self.seed,) = job.seeds
        self.record = job.out / job.record
        self._started = self._clock = 0.0

    def begin(self) -> None:
        """Enter that the match begins."""
        self._started, self._clock = time.time(), time.perf_counter()
        self._session.ledger.begin(self.job.stem)

    def end(self, outcome: MatchOutcome) -> Plan | None:
        """Enter how it went, and return the plan of the next one."""
        job, played = self.job, PlayedMatch(outcome.match, outcome.seats)
        row = MatchRow.of(job.index, (seat_row(job, played, 0),), job.record)
        result = JobResult(
            job, row, match_timing(job, played, self._started, time.perf_counter() - self._clock)
        )
        self._session.ledger.end(result)
        self._session.done.append(result)
        return self._session.following


@contextmanager
def person_in_suite(
    name: str, suite_name: str, seed: int, track: str | None, out: Path | None, *, fresh: bool
) -> Iterator[Plan | None]:
    """Let a person play the matches of a suite within the block, and show the results after it.

    Yields the plan of the first match that is left; None if all were played. Without a track, all are played.
    Without ``out``, a numbered folder is used, or the one in which this was interrupted. UserError if the
    suite has no such track, or a match that people cannot play.
    """
    suite = find_suite(suite_name)
    if track is not None:
        check_suite_has(suite, track)
    tracks = tuple(suite.tracks) if track is None else (track,)
    manifest = Manifest(name=name, version="person", tracks=tracks, interface="keys")
    plan = PersonPlan(
        submissions=(Submission(Path(), manifest, digest=""),),
        suite=suite,
        seed=SuiteSeed(seed),
        replays="none",
        jobs=1,
        out=out or EVALUATIONS,
        fresh=fresh,
        sandbox=BROWSER,
        tracks=tracks,
    )
    plan = plan if out else plan.in_own_folder()
    check_out(plan.out, ())
    _check_matches(plan)
    with output_folder(plan.out, plan.identity(), fresh=plan.fresh):
        if suite.source is not None:
            write_whole(plan.out / SUITE_FILE, suite.source)
        session = PersonSession(plan)
        yield session.following
        session.finish()


def _check_matches(plan: PersonPlan) -> None:
    """Check that each match waits for its person, who has the first seat, and that robots have the others."""
    for track in plan.tracks:
        for spec in plan.matches(track):
            if spec.clock == "running" or spec.thinking.budget is not None:
                raise UserError(
                    f"people can pause their matches, and those of {track} in suite {plan.suite.name} do not "
                    "wait",
                    exit_code=2,
                )
            if spec.seats[0] != SUBMISSION or SUBMISSION in spec.seats[1:]:
                raise UserError(
                    f"people play matches whose first seat alone is a submission's, and those of {track} in "
                    f"suite {plan.suite.name} have others",
                    exit_code=2,
                )
