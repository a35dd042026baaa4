"""Standings: the ranking on each track, from the latest evaluation of every submission in some folders."""

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from wildscav.errors import UserError
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.output.layout import COMPARISON_FILE, RESULTS_FILE, TOURNAMENT_FILE
from wildscav_evaluator.output.results import (
    BROWSER,
    Evaluation,
    KeptLimits,
    ModelTerms,
    Overall,
    Results,
    Timings,
    Versions,
    read_results,
)

if TYPE_CHECKING:  # loads SciPy, which most commands can do without
    from wildscav_evaluator.tournaments.tournament_file import Tournament

Shared = TypeVar("Shared")  # the conditions of a table
Placed = TypeVar("Placed")  # its rows


class Conditions(NamedTuple):
    """What an evaluation depends on besides its submission. Only equal ones allow a comparison."""

    track: str
    suite: str
    seed: str  # or the beginning of the commitment, if it is hidden
    rounds: int
    versions: Versions
    sandbox: str
    limits: KeptLimits  # that the sandbox enforced
    clock: str | None = None  # with the price of thinking; None: the suite's own
    model: ModelTerms | None = None  # that agents could ask


class Row(NamedTuple):
    """One submission's place in the standings."""

    rank: int | None  # 1 is the best; equal scores share a rank; None without a score
    evaluation: Evaluation
    started: str  # ISO 8601, UTC
    key: str | None  # public key that its ledger is signed with


class Standings(NamedTuple):
    """The ranking of comparable evaluations on one suite of one track."""

    conditions: Conditions
    rows: tuple[Row, ...]


class Found(NamedTuple):
    """The evaluations and tournaments in some folders."""

    evaluations: tuple[Results, ...]
    tournaments: "tuple[tuple[str, Tournament], ...]"  # each with the moment it started, ISO 8601, UTC
    unreadable: tuple[str, ...]  # what is left out, and why, a line each


def find_results(places: Iterable[Path]) -> Found:
    """Read the results in files, folders of evaluations, and folders that contain such folders at any depth.

    Only what is named itself must be readable. Comparisons inside a folder are left out. UserError if a place
    does not exist, or is a file that holds no results.
    """
    from wildscav_evaluator.tournaments.tournament_file import Tournament

    evaluations, tournaments, unreadable = [], [], []
    for place in places:
        if not place.exists():
            raise UserError(f"{place} does not exist", exit_code=2)
        for path in _results_files(place):
            try:
                results = read_results(path)
                if results.tournament is None:
                    evaluations.append(results)
                else:
                    rated = Tournament.read(path.with_name(TOURNAMENT_FILE))
                    tournaments.append((results.timings.started, rated))
            except (UserError, OSError) as error:
                if path in (place, place / RESULTS_FILE):
                    raise
                unreadable.append(str(error))
    return Found(tuple(evaluations), tuple(tournaments), tuple(unreadable))


def _results_files(place: Path) -> Iterator[Path]:
    if place.is_file():
        yield place
        return
    for folder, below, files in os.walk(place):
        if RESULTS_FILE in files or COMPARISON_FILE in files:
            below.clear()  # its folders are of its matches
            if COMPARISON_FILE not in files:
                yield Path(folder) / RESULTS_FILE
        below.sort()


def is_meant(asked: str | None, name: str) -> bool:
    """Return whether a track or suite matches the requested name or prefix; None matches all."""
    return asked is None or name.startswith(asked)


def standings(
    evaluated: Iterable[Results], track: str | None = None, suite: str | None = None
) -> Iterator[Standings]:
    """Yield the standings of each set of comparable evaluations on the requested tracks and suites.

    A submission appears once, under its name and interface, with its latest evaluation. A newer version
    replaces an older one even if it is worse, since it is its author's current choice.
    """
    rows = [
        (
            _conditions(results, one.track),
            (one.submission, one.interface or ""),
            Row(None, one, results.timings.started, results.key),
        )
        for results in _by_age(evaluated)
        for one in results.evaluations
        if is_meant(track, one.track) and is_meant(suite, results.suite)
    ]
    tables = _tables(rows, lambda agents: agents._replace(**BY_PEOPLE, limits=KeptLimits()))
    for conditions, latest in sorted(tables, key=_sort_key):
        row_of = {id(row.evaluation): row for row in latest}
        ranks = ranked(row.evaluation for row in latest)
        yield Standings(conditions, tuple(row_of[id(one)]._replace(rank=rank) for rank, one in ranks))


class OverallStandings(NamedTuple):
    """The ranking of comparable evaluations across all tracks of a suite."""

    conditions: Results  # without ``MAY_DIFFER``
    rows: tuple[tuple[int, Overall], ...]  # with ranks, best first


# What comparable evaluations may differ in, and what stands in its place.
MAY_DIFFER: dict[str, Any] = {
    "key": None,
    "evaluations": (),
    "overall": None,
    "timings": Timings(started="", wall=0.0, jobs=0, matches=()),
}


def overall_standings(evaluated: Iterable[Results], suite: str | None = None) -> Iterator[OverallStandings]:
    """Yield the standings across tracks of each set of comparable evaluations; see ``standings``."""
    rows = [
        (results.model_copy(update=MAY_DIFFER), (one.submission, one.interface or ""), one)
        for results in _by_age(evaluated)
        for one in results.overall or ()
        if is_meant(suite, results.suite)
    ]
    tables = _tables(rows, lambda agents: agents.model_copy(update=BY_PEOPLE | {"limits": {}}))
    for conditions, latest in sorted(tables, key=lambda table: table[0].model_dump_json()):
        yield OverallStandings(conditions, ranked_overall(latest))


def _by_age(evaluated: Iterable[Results]) -> list[Results]:
    return sorted(evaluated, key=lambda results: results.timings.started)


BY_PEOPLE: dict[str, Any] = {"sandbox": BROWSER, "model": None}  # who have no limits, too


def _tables(
    rows: Sequence[tuple[Shared, tuple[str, str], Placed]], by_people: Callable[[Shared], Shared]
) -> Iterator[tuple[Shared, list[Placed]]]:
    """Yield the latest rows of each set of equal conditions, by name.

    Each of the rows, the earliest first, stands behind its conditions, its name and its interface. Those of
    people stand in each table of agents that played the same matches, or else in one of their own:
    ``by_people`` returns the conditions under which people play what agents play.
    """
    distinct: list[Shared] = []  # they cannot be hashed: a model has a dictionary
    for conditions, _, _ in rows:
        if conditions not in distinct:
            distinct.append(conditions)
    beside_agents = [person for each in distinct if (person := by_people(each)) != each]
    for table in distinct:
        if table not in beside_agents:
            compared = (table, by_people(table))
            # A person and an agent may have the same name.
            latest = {(*name, one == table): row for one, name, row in rows if one in compared}
            yield table, [latest[key] for key in sorted(latest)]


def ranked_overall(rows: Iterable[Overall]) -> tuple[tuple[int, Overall], ...]:
    """Return ratings across tracks with their ranks, best first; equal ones share a rank."""
    ordered = sorted(rows, key=lambda one: (-one.mean.value, one.submission))
    return tuple((1 + sum(other.mean.value > one.mean.value for other in ordered), one) for one in ordered)


def latest_tournaments(
    results: Found, track: str | None = None, suite: str | None = None
) -> "list[Tournament]":
    """Return the latest tournament on each suite of each track by each clock and model, if requested."""
    latest = {
        (one.track, one.suite, str(one.clock), repr(one.model)): one
        for _, one in sorted(results.tournaments, key=lambda pair: pair[0])
        if is_meant(track, one.track) and is_meant(suite, one.suite)
    }
    return [latest[key] for key in sorted(latest)]


def _conditions(results: Results, track: str) -> Conditions:
    return Conditions(
        track=track,
        suite=results.suite,
        seed=results.seed_label,
        rounds=results.rounds,
        versions=results.versions,
        sandbox=results.sandbox,
        limits=results.limits.get(track, KeptLimits()),
        clock=None if results.clock is None else str(results.clock),
        model=results.model,
    )


def _sort_key(pair: tuple[Conditions, object]) -> tuple[object, ...]:
    """Return the sort key of the standings: the engine's order of the tracks, then the conditions."""
    conditions, tracks = pair[0], list(TRACKS)
    place = tracks.index(conditions.track) if conditions.track in tracks else len(tracks)
    versions, limits = conditions.versions, conditions.limits
    return (
        place,
        *conditions[:4],
        *(versions.engine, versions.simulation, versions.generator, versions.record),
        conditions.sandbox,
        limits.model_dump_json(exclude_none=True),
        conditions.clock or "",
        "" if conditions.model is None else conditions.model.model_dump_json(),
    )


def ranked(evaluations: Iterable[Evaluation]) -> list[tuple[int | None, Evaluation]]:
    """Return the evaluations of one track with their ranks, best first; equal scores share a rank.

    Those without a score come last and have no rank.
    """
    ones = list(evaluations)
    scored = sorted(
        (one for one in ones if one.score is not None), key=lambda one: (_order(one), one.submission)
    )
    ranks = [1 + sum(_order(other) < _order(one) for other in scored) for one in scored]
    return [*zip(ranks, scored, strict=True), *((None, one) for one in ones if one.score is None)]


def _order(evaluation: Evaluation) -> float:
    """Return the sort key of a scored evaluation; less is better."""
    metric = evaluation.metrics[0]
    mean = evaluation.summary[metric.name].mean
    return mean if metric.lower_is_better else -mean


def document(one: Standings) -> dict[str, Any]:
    """Return the standings on one suite of one track as ``wildscav leaderboard --json`` prints them."""
    shared = one.conditions._asdict()
    versions: Versions = shared.pop("versions")
    named = {f"{part}_version": number for part, number in versions}
    limits, model = one.conditions.limits.model_dump(exclude_none=True), shared.pop("model")
    shared |= {} if model is None else {"model": model.model_dump()}
    return shared | named | {"limits": limits, "rows": [_document_of_row(row) for row in one.rows]}


def document_of_overall(one: OverallStandings) -> dict[str, Any]:
    """Return the standings across tracks as ``wildscav leaderboard --json`` prints them."""
    shared: dict[str, Any] = one.conditions.model_dump(mode="json", exclude={"format", *MAY_DIFFER})
    return shared | {"rows": [{"rank": rank, **row.as_json()} for rank, row in one.rows]}


def _document_of_row(row: Row) -> dict[str, Any]:
    one = row.evaluation
    measured: Sequence[dict[str, Any]] = [
        metric.model_dump() | one.summary[metric.name].model_dump()
        for metric in one.metrics
        if metric.name in one.summary
    ]
    return {
        "rank": row.rank,
        "submission": one.submission,
        "version": one.version,
        "digest": one.digest,
        "interface": one.interface or "numbers",
        "started": row.started,
        "key": row.key,
        "matches": len(one.matches),
        "faults": one.faults,
        "scores": measured,
    }
