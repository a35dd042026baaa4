"""The matches that an evaluation should have played, from the suite and the seed in its output folder."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from wildscav.errors import UserError
from wildscav_engine.record import RecordError, read_record
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.output.layout import OPENED_FILE, RESULTS_FILE, SUITE_FILE
from wildscav_evaluator.output.record_names import parse_name, record_paths
from wildscav_evaluator.output.results import SCHEDULE_VERSION, Results, read_results
from wildscav_evaluator.seats import entrants_in_names
from wildscav_evaluator.suites.seeds import SuiteSeed, read_secret
from wildscav_evaluator.suites.suite import SUITES, Suite, match_count, matches_in_rounds
from wildscav_evaluator.suites.suite_file import read_suite
from wildscav_evaluator.tournaments.drawing import (
    is_of_game,
    suite_games,
    tournament_match_count,
    tournament_matches,
)


class ExpectedMatch(NamedTuple):
    """A match as the suite, or the schedule of a tournament, determines it."""

    spec: MatchSpec
    names: tuple[str, ...] | None = None  # the display name of every seat; None in an evaluation

    @property
    def entrants(self) -> set[str]:
        """The entrants of a match of a tournament."""
        return set(entrants_in_names(self.spec.seats, self.names or ()).values())

    def is_played_by(self, spec: MatchSpec, names: tuple[str, ...]) -> bool:
        """Return whether a record with this spec and these display names is of this match."""
        return self.spec == spec and self.names in (None, names)


def kind_of(reported: Results) -> str:
    """Return what determined the matches: the suite, or the tournament's schedule."""
    return "suite" if reported.tournament is None else "tournament"


def expected_matches(out: Path, reported: Results) -> Mapping[str, Sequence[ExpectedMatch]] | None:
    """Return the matches that should have been played, by track; None if they are not known.

    They are not known while their seed is hidden, and of a tournament with a schedule of an earlier version.
    UserError if the suite's own file, or the opened secret, is not that of the results.
    """
    suite = played_suite(out, reported)
    known = known_seed(out, reported)
    if known is None or has_older_schedule(reported):
        return None
    seed = known.value
    played = [track for track in reported.tracks if track in suite.tracks]
    if reported.tournament is None:
        return {
            track: [ExpectedMatch(spec) for spec in matches_in_rounds(suite, track, seed, reported.rounds)]
            for track in played
        }
    entrants = entrants_of(reported)
    return {
        track: [
            ExpectedMatch(match.spec, match.names)
            for match in tournament_matches(
                suite, track, seed, reported.rounds, reported.tournament, entrants
            )
        ]
        for track in played
    }


Judge = Callable[[str, int, MatchSpec, tuple[str, ...]], bool]  # of a track, a number, a spec and names


def judge_of(
    out: Path, reported: Results, expected: Mapping[str, Sequence[ExpectedMatch]] | None
) -> Judge | None:
    """Return what says whether a record is of the match with its number; None while the seed is hidden.

    Of a schedule of an earlier version, each match must be of the seed's next game; who plays in it is not
    derived.
    """
    if expected is not None:
        return lambda track, index, spec, names: (
            index < len(matches := expected.get(track, ())) and matches[index].is_played_by(spec, names)
        )
    known, settings = known_seed(out, reported), reported.tournament
    if known is None or settings is None:
        return None
    suite, counts = played_suite(out, reported), match_counts(out, reported)
    games = {
        track: suite_games(suite, track, known.value, counts[track] // settings.repeats)
        for track in reported.tracks
        if track in suite.tracks
    }

    def is_of_next_game(track: str, index: int, spec: MatchSpec, names: tuple[str, ...]) -> bool:
        number, rated = index // settings.repeats, tuple(entrants_in_names(spec.seats, names))
        of_track = games.get(track, [])
        return number < len(of_track) and is_of_game(spec, of_track[number], rated, settings)

    return is_of_next_game


def match_counts(out: Path, reported: Results) -> Mapping[str, int]:
    """Return how many matches should have been played on each track, which does not depend on the seed.

    UserError if the suite's own file is not that of the results, or there are too many.
    """
    if reported.tournament is not None:
        count = tournament_match_count(reported.rounds, reported.tournament, entrants_of(reported))
        return dict.fromkeys(reported.tracks, count)
    suite = played_suite(out, reported)
    return {name: match_count(suite, name, reported.rounds) for name in suite.tracks}


def has_older_schedule(reported: Results) -> bool:
    """Return whether a tournament has a schedule of an earlier version, which is not made any more."""
    return reported.tournament is not None and reported.tournament.schedule < SCHEDULE_VERSION


def entrants_of(reported: Results) -> list[str]:
    """Return the names of a tournament's entrants, sorted; UserError if a later version made its schedule."""
    if reported.tournament is not None and reported.tournament.schedule > SCHEDULE_VERSION:
        raise UserError(
            f"the tournament was played with version {reported.tournament.schedule} of its schedule, and "
            f"this is version {SCHEDULE_VERSION}: check it with the Wildscav that played it, "
            f"{reported.versions.engine}"
        )
    return sorted(one.submission for one in reported.evaluations)


def played_suite(out: Path, reported: Results) -> Suite:
    """Return the suite of an evaluation; an organizer's own is read from the copy of its file.

    UserError if that is missing or is another suite, or the suite's package has another version.
    """
    name = reported.suite.partition("@")[0]
    if name in SUITES and not (out / SUITE_FILE).exists():
        if SUITES[name].label != reported.suite:
            raise UserError(f"{reported.suite} was played, but installed is {SUITES[name].label}")
        return replace(SUITES[name], clock=reported.clock)
    suite = read_suite(out / SUITE_FILE)
    if suite.label != reported.suite:
        raise UserError(f"{out / SUITE_FILE} is the suite {suite.label}, but {reported.suite} was played")
    return replace(suite, clock=reported.clock)


def known_seed(out: Path, reported: Results) -> SuiteSeed | None:
    """Return the seed of an evaluation, if it is public or its secret was opened; None while it is hidden.

    UserError if it is not the one that was committed to.
    """
    if reported.commitment is None:
        return None if reported.seed is None else SuiteSeed(reported.seed)
    path = out / OPENED_FILE
    if not path.exists():
        return None
    seed = read_secret(path)
    if seed.commitment != reported.commitment:
        raise UserError(f"{path} is not the secret of the commitment {reported.commitment}")
    return seed


def check_opened(out: Path, commitment: str) -> int:
    """Check that an evaluation played the matches of the secret that was committed to; count its records.

    UserError if it played other matches, or its secret was not opened.
    """
    reported = read_results(out / RESULTS_FILE)
    if reported.commitment != commitment:
        played = (
            "on a public seed"
            if reported.commitment is None
            else f"with the commitment {reported.commitment}"
        )
        raise UserError(f"{out} was evaluated {played}, not with {commitment}")
    judge = judge_of(out, reported, expected_matches(out, reported))
    if judge is None:
        raise UserError(f"the secret of {out} is not opened: use `wildscav season secret open FILE {out}`")
    paths = record_paths(out)
    for path in paths:
        if not _is_expected(path, judge):
            raise UserError(f"{path} is not of a match that the secret determines")
    return len(paths)


def _is_expected(path: Path, judge: Judge) -> bool:
    name = parse_name(path)
    if name is None:
        return False
    try:
        record = read_record(path)
    except RecordError as error:
        raise UserError(str(error)) from error
    return judge(name.track, name.match, record.spec, record.names)
