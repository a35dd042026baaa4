"""The change since the last evaluation of a submission, from the matches that both versions played."""

from collections.abc import Iterator
from pathlib import Path

from wildscav.errors import UserError
from wildscav_evaluator.output.json_files import FileModel
from wildscav_evaluator.output.layout import RESULTS_FILE
from wildscav_evaluator.output.numbered_folders import NUMBERED, identity_in, numbered
from wildscav_evaluator.output.results import Evaluation, Results, read_results
from wildscav_evaluator.scores.compare import Comparison, compare_evaluations

MAX_SEARCHED = 50  # earlier evaluations, at most


class Change(FileModel):
    """One submission on one track, now and when it was last evaluated with other files."""

    folder: str  # of the earlier evaluation
    version: str  # the version that was evaluated there
    comparison: Comparison  # first: now, second: then


def changes_since_last(results: Results, out: Path) -> tuple[Change, ...]:
    """Compare every submission with its last evaluation on the same matches with other files.

    Args:
        results: The results of this evaluation.
        out: Its folder. If that has no number, its predecessors are not known.
    """
    wanted = {(one.submission, one.track): one for one in results.evaluations}
    found: dict[tuple[str, str], Change] = {}
    for folder, earlier in _earlier(results, out):
        for then in earlier.evaluations:
            key = then.submission, then.track
            now = wanted.get(key)
            if now is None or key in found or then.digest == now.digest or not _same(earlier, results, then):
                continue
            comparison = compare_evaluations(now, then)
            if comparison.differences:
                found[key] = Change(folder=folder.name, version=then.version, comparison=comparison)
        if len(found) == len(wanted):
            break
    return tuple(found[key] for key in wanted if key in found)


def _earlier(results: Results, out: Path) -> Iterator[tuple[Path, Results]]:
    """Yield the other numbered evaluations that share a submission with this one, the latest first."""
    if not NUMBERED.fullmatch(out.name):
        return
    names = {one.submission for one in results.evaluations}
    for folder in numbered(out.parent)[: -MAX_SEARCHED - 1 : -1]:
        identity = identity_in(folder)
        if folder.name == out.name or identity is None:
            continue
        if names.isdisjoint(one.name for one in identity.submissions):
            continue
        try:
            yield folder, read_results(folder / RESULTS_FILE)
        except (UserError, OSError):
            continue  # it was not completed


def _same(earlier: Results, now: Results, on: Evaluation) -> bool:
    """Return whether two evaluations played the same matches of a track, under the same conditions."""
    return (
        (earlier.versions, earlier.suite, earlier.seed, earlier.commitment, earlier.rounds, earlier.sandbox)
        == (now.versions, now.suite, now.seed, now.commitment, now.rounds, now.sandbox)
    ) and earlier.limits.get(on.track) == now.limits.get(on.track)
