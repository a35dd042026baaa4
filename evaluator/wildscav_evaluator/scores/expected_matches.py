"""The matches that an evaluation should have played, from the suite and the seed in its output folder."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from wildscav.errors import UserError
from wildscav_engine.record import RecordError, read_record
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.output.layout import OPENED_FILE, RESULTS_FILE, SUITE_FILE
from wildscav_evaluator.output.record_names import parse_name, record_paths
from wildscav_evaluator.output.results import Results, read_results
from wildscav_evaluator.suites.rounds import match_count, matches_in_rounds
from wildscav_evaluator.suites.seeds import SuiteSeed, read_secret
from wildscav_evaluator.suites.suite import SUITES, Suite
from wildscav_evaluator.suites.suite_file import read_suite


def expected_matches(out: Path, reported: Results) -> Mapping[str, Sequence[MatchSpec]] | None:
    """Return the matches of the suite that was played, by track; None while its seed is hidden.

    Raises:
        UserError: The suite's own file, or the opened secret, is not that of the results.
    """
    suite = played_suite(out, reported)
    seed = reported.seed
    if reported.commitment is not None:
        opened = opened_secret(out, reported)
        seed = None if opened is None else opened.value
    if seed is None:
        return None
    played = [track for track in reported.tracks if track in suite.tracks]
    return {track: matches_in_rounds(suite, track, seed, reported.rounds) for track in played}


def match_counts(out: Path, reported: Results) -> Mapping[str, int]:
    """Return how many matches the suite has on each of its tracks, which does not depend on its seed.

    Raises:
        UserError: The suite's own file is not that of the results, or there are too many.
    """
    suite = played_suite(out, reported)
    return {name: match_count(suite, name, reported.rounds) for name in suite.tracks}


def played_suite(out: Path, reported: Results) -> Suite:
    """Return the suite of an evaluation; an organizer's own is read from the copy of its file.

    Raises:
        UserError: The copy is missing or is another suite, or the suite's package has another version.
    """
    name = reported.suite.partition("@")[0]
    if name in SUITES and not (out / SUITE_FILE).exists():
        if SUITES[name].label != reported.suite:
            raise UserError(f"{reported.suite} was played, but installed is {SUITES[name].label}")
        return SUITES[name]
    suite = read_suite(out / SUITE_FILE)
    if suite.label != reported.suite:
        raise UserError(f"{out / SUITE_FILE} is the suite {suite.label}, but {reported.suite} was played")
    return suite


def opened_secret(out: Path, reported: Results) -> SuiteSeed | None:
    """Return the seed of an evaluation whose secret was opened; None if it is still hidden.

    Raises:
        UserError: The secret is not the one that was committed to.
    """
    path = out / OPENED_FILE
    if not path.exists():
        return None
    seed = read_secret(path)
    if seed.commitment != reported.commitment:
        raise UserError(f"{path} is not the secret of the commitment {reported.commitment}")
    return seed


def check_opened(out: Path, commitment: str) -> int:
    """Check that an evaluation played the matches of the secret that was committed to.

    Args:
        out: The output folder.
        commitment: As it was published.

    Returns:
        The number of records.

    Raises:
        UserError: It played other matches, or its secret was not opened.
    """
    reported = read_results(out / RESULTS_FILE)
    if reported.commitment != commitment:
        played = (
            "on a public seed"
            if reported.commitment is None
            else f"with the commitment {reported.commitment}"
        )
        raise UserError(f"{out} was evaluated {played}, not with {commitment}")
    expected = expected_matches(out, reported)
    if expected is None:
        raise UserError(f"the secret of {out} is not opened: use `wildscav secret open FILE {out}`")
    paths = record_paths(out)
    for path in paths:
        if not _is_expected(path, expected):
            raise UserError(f"{path} is not of a match that the secret determines")
    return len(paths)


def _is_expected(path: Path, expected: Mapping[str, Sequence[MatchSpec]]) -> bool:
    name = parse_name(path)
    if name is None or name.match >= len(expected.get(name.track, ())):
        return False
    try:
        return read_record(path).spec == expected[name.track][name.match]
    except RecordError as error:
        raise UserError(str(error)) from error
