"""What ``wildscav verify`` does and shows for an evaluation."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from wildscav.errors import UserError
from wildscav.terminal.console import console, counted, print_json, progress_bar
from wildscav_evaluator.cli.result_tables import sandbox_and_limits
from wildscav_evaluator.cli.sessions.evaluate import show_scores
from wildscav_evaluator.cli.sessions.playing import raise_errors
from wildscav_evaluator.cli.sessions.tournament import show_ratings
from wildscav_evaluator.executors import Executor
from wildscav_evaluator.ledger.ledger import LedgerError, check_key, read_ledger
from wildscav_evaluator.output.identity import Identity, read_identity
from wildscav_evaluator.output.layout import LEDGER_FILE, OPENED_FILE, RESULTS_FILE
from wildscav_evaluator.output.record_names import record_paths
from wildscav_evaluator.output.results import CURRENT_VERSIONS, Results, Timings, read_results
from wildscav_evaluator.scores.audit import AuditedFolder, discrepancies, read_folder
from wildscav_evaluator.scores.expected_matches import check_opened, has_older_schedule, played_suite
from wildscav_evaluator.scores.overall import overall_of
from wildscav_evaluator.scores.rescore import Replayed, recompute, replay_all
from wildscav_evaluator.tournaments.tournament_file import tournament_of

SHOWN = 20  # disagreements, at most


def run_rescore(out: Path, executor: Executor, key: str | None = None, *, as_json: bool = False) -> None:
    """Play the records of a folder again, show the tables that follow from them, and report disagreements.

    ``key`` is the public key that must have signed its ledger; None for any. UserError if there are no
    records or, after everything was shown, if they do not agree with the results.
    """
    paths = record_paths(out)
    reported = read_results(out / RESULTS_FILE) if (out / RESULTS_FILE).exists() else None
    folder = None if reported is None else read_folder(out, reported, key)
    replayed = _replay(paths, executor)
    results = recomputed(out, replayed, reported, read_identity(out))
    disagreements = [f"{out / one.record}: {one.fault}" for one in replayed if one.fault]
    disagreements += _show(results)
    disagreements += (
        _without_results(out, key) if folder is None else discrepancies(folder, replayed, results)
    )
    unchecked = [] if folder is None else list(_unchecked(folder))
    if as_json:
        document = {"folder": str(out), "results": results.as_json(), "disagreements": disagreements}
        print_json(document | {"unchecked": unchecked})
    if len(disagreements) > SHOWN:
        disagreements[SHOWN:] = [f"and {len(disagreements) - SHOWN:,} more disagreements"]
    raise_errors(disagreements)
    everything = counted(len(replayed), "record")
    if folder is None:
        console.print(f"{everything} played again; there is no {out / RESULTS_FILE} to compare with")
        return
    console.print(f"{everything} played again: all agree with {out / RESULTS_FILE}")
    _print_conclusion(folder)
    for sentence in unchecked:
        console.print(sentence)


def show_commitment(out: Path, commitment: str) -> None:
    """Check that the recorded matches are those of the secret that was committed to, and print so."""
    records = check_opened(out, commitment)
    of_it = "record is of a match" if records == 1 else "records are of matches"
    console.print(
        f"the secret in {out} is the one committed to, and {records:,} {of_it} that the secret determines"
    )


def _without_results(out: Path, key: str | None) -> Iterator[str]:
    """Yield the errors of a folder that has no results."""
    try:
        ledger = read_ledger(out)
        if key is not None:
            check_key(ledger, key, out)
    except LedgerError as error:
        yield str(error)
        return
    if ledger is not None and ledger.closed is not None:
        yield f"there is no {out / RESULTS_FILE}, though the ledger says that the evaluation was completed"
    elif key is not None:
        yield f"the evaluation in {out} was not completed: it has no signed results yet"


def _print_conclusion(folder: AuditedFolder) -> None:
    """Print what the agreement of all records proves, and what it does not."""
    ledger = folder.ledger
    if ledger is None:
        raise TypeError("a folder without a ledger does not agree")
    if folder.signed:
        console.print(
            f"signed with the key {ledger.key}: nothing was changed or removed since; head {ledger.head}"
        )
    elif ledger.key is not None:
        console.print(f"signed with the key {ledger.key}: if that is the organizer's, confirm it with --key")
    else:
        console.print(
            "not signed: the recorded actions give these scores; it is not proven that nobody substituted "
            "the actions, the sandbox or the submission"
        )
    if again := sum(ledger.interrupted.values()):
        were = "was" if again == 1 else "were"
        console.print(f"{counted(again, 'match')} {were} interrupted and restarted: see {LEDGER_FILE}")


def _unchecked(folder: AuditedFolder) -> Iterator[str]:
    """Yield what records and results cannot prove yet, or not with this version."""
    if folder.reported.commitment is not None and not (folder.out / OPENED_FILE).exists():
        yield "Whether these are the suite's matches can be checked once its secret is opened."
    if has_older_schedule(folder.reported):
        yield (
            "Its schedule is of an earlier version: the Wildscav that played it, "
            f"{folder.reported.versions.engine}, can also check that the seed decided who met whom."
        )


def recomputed(
    out: Path, replayed: Sequence[Replayed], reported: Results | None, identity: Identity | None = None
) -> Results:
    """Return results that are recomputed from records.

    ``reported`` is the source of everything that records do not contain; without results yet, ``identity``
    is. ``out`` has the file of an organizer's own suite.
    """
    evaluations = tuple(recompute(replayed, reported))
    if reported is not None:
        return _rated(out, reported.model_copy(update={"evaluations": evaluations}))
    nothing = Timings(started="", wall=0.0, jobs=0, matches=())
    unknown = {"suite": "unknown", "sandbox": "unknown"} if identity is None else {}
    results = Results.about(
        identity,
        versions=CURRENT_VERSIONS,
        seed=None if identity is None else _public_seed(identity),
        commitment=None,
        key=None,
        evaluations=evaluations,
        timings=nothing,
        **unknown,
    )
    return results if identity is None else _rated(out, results)


def _rated(out: Path, results: Results) -> Results:
    """Return results with the ratings across tracks that follow from their scores."""
    is_tournament = results.tournament is not None
    rated = None if is_tournament else overall_of(played_suite(out, results), results.evaluations)
    return results.model_copy(update={"overall": rated})


def _public_seed(identity: Identity) -> int | None:
    """Return the seed of an evaluation; None if it is hidden, or not a number that can be read."""
    try:
        return int(identity.seed)
    except ValueError:
        return None


def _replay(paths: Sequence[Path], executor: Executor) -> list[Replayed]:
    replayed = []
    with progress_bar() as progress:
        task = progress.add_task("playing records again", total=len(paths))
        try:
            for one in replay_all(paths, executor):
                replayed.append(one)
                progress.advance(task)
        except KeyboardInterrupt:
            raise UserError("interrupted: not all records were played again", 130) from None
    return replayed


def _show(results: Results) -> Iterator[str]:
    """Print the tables that follow from the records, and yield an error if there can be none."""
    if results.tournament is not None:
        try:
            show_ratings(tournament_of(results))
        except ValueError as error:
            yield f"there are no ratings: {error}"
    else:
        show_scores(results)
    if results.limits:
        for line in sandbox_and_limits(results.sandbox, results.limits):
            console.print(f"played in {line}")
