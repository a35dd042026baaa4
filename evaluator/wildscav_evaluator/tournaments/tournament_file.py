"""The file of a tournament: its ratings, which follow from its results."""

import contextlib
from pathlib import Path
from typing import Literal

from wildscav.terminal.console import counted
from wildscav_engine.specs.thinking import ClockChoice
from wildscav_evaluator.output.json_files import FileModelError, WithOptionalFields
from wildscav_evaluator.output.layout import RESULTS_FILE, TOURNAMENT_FILE
from wildscav_evaluator.output.results import (
    KeptLimits,
    MetricInfo,
    ModelTerms,
    OtherInterface,
    Results,
    Summary,
    TournamentSettings,
    Versions,
    of_clock,
)
from wildscav_evaluator.ratings.standings import Standings, rate
from wildscav_evaluator.tournaments.rated_matches import placing_metric, rated_matches


class RatedEntrant(WithOptionalFields):
    """An entrant of a tournament."""

    omitted = ("interface",)

    name: str
    version: str
    digest: str  # of its files; empty for a robot
    interface: OtherInterface | None = None  # by which it plays; omitted for numbers
    faults: int  # matches in which something went wrong
    score: Summary | None  # over its matches; None if none was played


class Tournament(WithOptionalFields):
    """The ratings of a tournament."""

    omitted = ("clock", "model")

    format: Literal[1] = 1
    versions: Versions  # with which it was played
    track: str
    suite: str
    seed: str  # or the beginning of the commitment, if it is hidden
    rounds: int
    settings: TournamentSettings
    sandbox: str  # in which agents ran
    limits: KeptLimits  # of each agent in it
    clock: ClockChoice | None = None  # of all matches; omitted if they had the suite's own
    model: ModelTerms | None = None  # that agents could ask; omitted if there was none
    placed_by: MetricInfo  # the metric by which the teams of a match are placed
    matches: int  # with a result
    failed: int  # without one, by the platform's fault
    score: MetricInfo  # the metric that evaluations of single submissions rank by
    entrants: tuple[RatedEntrant, ...]  # by name
    ratings: Standings

    @property
    def title(self) -> str:
        """A short description of what was played."""
        size = f"{counted(len(self.ratings.standings), 'entrant')} · {counted(self.matches, 'match')}"
        return f"{self.track} · {size} · suite {self.suite} · seed {self.seed}{of_clock(self.clock)}"


def tournament_of(results: Results) -> Tournament:
    """Return the ratings that follow from a tournament's results; ValueError if these cannot be rated."""
    settings, evaluations = results.tournament, results.evaluations
    if settings is None or not evaluations or len(results.tracks) != 1:
        raise ValueError("the results are not those of a tournament on one track")
    rated = list(rated_matches(results, settings.repeats))
    indices = {row.index for one in evaluations for row in one.matches}
    return Tournament.about(
        results,
        format=1,
        track=evaluations[0].track,
        seed=results.seed_label,
        settings=settings,
        limits=results.limits.get(evaluations[0].track, KeptLimits()),
        placed_by=placing_metric(evaluations[0].metrics),
        matches=len(rated),
        failed=len(indices) - len(rated),
        score=evaluations[0].metrics[0],
        entrants=tuple(RatedEntrant.about(one, name=one.submission) for one in evaluations),
        ratings=rate(rated),
    )


def check_tournament(out: Path, results: Results) -> str:
    """Return why the ratings in a folder, if any, do not follow from some results; empty if they do."""
    path = out / TOURNAMENT_FILE
    try:
        reported = Tournament.read(path)
    except FileNotFoundError:
        return "" if results.tournament is None else f"there is no {path}: the ratings are missing"
    except FileModelError as error:
        return f"{path} is not the file of a tournament: {error}"
    with contextlib.suppress(KeyError, ValueError):  # raised if the results cannot be rated
        if reported == tournament_of(results):
            return ""
    return f"the ratings in {TOURNAMENT_FILE} are not those that the results in {RESULTS_FILE} give"
