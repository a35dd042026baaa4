"""``wildscav rescore`` as its user sees it."""

from collections.abc import Sequence
from pathlib import Path

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from wildscav.console import console, counted, error_console
from wildscav.errors import UserError
from wildscav_evaluator.cli.complaints import raise_all
from wildscav_evaluator.cli.tables import LEGEND, track_table
from wildscav_evaluator.cli.time_table import conditions
from wildscav_evaluator.output.identity import Identity, read_identity
from wildscav_evaluator.output.opening import expected_matches
from wildscav_evaluator.output.results import RESULTS_FILE, Results, Timings, read_results
from wildscav_evaluator.output.versions import CURRENT_VERSIONS
from wildscav_evaluator.scores.rescore import Replayed, disagreements, recompute, record_paths, replay_all

SHOWN = 20  # disagreements, at most


def run_rescore(out: Path, jobs: int) -> None:
    """Play the records of a folder again, show the tables that they make, and say whether they agree.

    Raises:
        UserError: There are no records; or they do not agree, after everything was shown.
    """
    paths = record_paths(out)
    told = read_results(out / RESULTS_FILE) if (out / RESULTS_FILE).exists() else None
    replayed = _replay(paths, jobs)
    _show(recomputed(replayed, told, read_identity(out)))
    complaints = [f"{out / one.record}: {one.fault}" for one in replayed if one.fault]
    everything = counted(len(replayed), "record")
    if told is None:
        raise_all(complaints)
        console.print(f"{everything} played again; there is no {out / RESULTS_FILE} to compare with")
        return
    expected = expected_matches(out, told)
    complaints += disagreements(replayed, told, expected)
    if len(complaints) > SHOWN:
        complaints[SHOWN:] = [f"and {len(complaints) - SHOWN:,} more disagreements"]
    raise_all(complaints)
    console.print(f"{everything} played again: all agree with {out / RESULTS_FILE}", soft_wrap=True)
    if expected is None:
        console.print("That these are the suite's matches can be checked once its secret is opened.")


def recomputed(
    replayed: Sequence[Replayed], told: Results | None, identity: Identity | None = None
) -> Results:
    """Return results made anew from records.

    Args:
        replayed: The records, played again.
        told: What the evaluation said; what no record says is taken from it.
        identity: Which evaluation it is, where it has not come to results yet.
    """
    evaluations = tuple(recompute(replayed, told))
    if told is not None:
        return told.model_copy(update={"evaluations": evaluations})
    nothing = Timings(started="", wall=0.0, jobs=0, matches=())
    return Results(
        versions=CURRENT_VERSIONS,
        suite="unknown" if identity is None else identity.suite,
        seed=int(identity.seed) if identity is not None and identity.seed.isdecimal() else None,
        sandbox="unknown" if identity is None else identity.sandbox,
        limits={} if identity is None else identity.limits,
        evaluations=evaluations,
        timings=nothing,
    )


def _replay(paths: Sequence[Path], jobs: int) -> list[Replayed]:
    columns = (TextColumn("playing records again"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    replayed = []
    with Progress(*columns, console=error_console, transient=True) as progress:
        task = progress.add_task("", total=len(paths))
        try:
            for one in replay_all(paths, jobs):
                replayed.append(one)
                progress.advance(task)
        except KeyboardInterrupt:
            raise UserError("interrupted: not all records were played again", 130) from None
    return replayed


def _show(results: Results) -> None:
    for track in results.tracks:
        console.print(track_table(results, track))
        console.print()
    console.print(f"{LEGEND}\n", style="dim")
    if results.limits:
        for line in conditions(results.sandbox, results.limits):
            console.print(f"played in {line}", soft_wrap=True, highlight=False)
