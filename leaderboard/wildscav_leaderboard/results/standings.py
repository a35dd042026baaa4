"""Standings: the ranking on each track, from the latest evaluation of every submission."""

import json
from collections.abc import Iterable, Iterator
from itertools import groupby
from typing import Any, NamedTuple

from sqlalchemy import select
from sqlalchemy.orm import Session, joinedload, selectinload

from wildscav_evaluator.output.results import MetricInfo, Summary
from wildscav_leaderboard.results import models
from wildscav_leaderboard.results.models import CONDITIONS, Evaluation


class Row(NamedTuple):
    """One submission's place in the standings."""

    rank: int | None  # 1 is the best; equal scores share a rank; None without a score
    evaluation: Evaluation


class Standings(NamedTuple):
    """The ranking of comparable evaluations on one suite of one track.

    Evaluations played the same matches only if their seed and their versions of the engine, its rules, its
    map generator and its records are equal. Their agents had equal conditions only in the same sandbox with
    the same limits.
    """

    track: str
    suite: str
    seed: str
    engine_version: str
    simulation_version: int  # 0 if it was not stored yet; the next two as well
    generator_version: int
    record_version: int
    sandbox: str
    limits: str  # that the sandbox enforced, as JSON
    rows: tuple[Row, ...]


def is_meant(asked: str | None, name: str) -> bool:
    """Return whether a track or suite matches the requested name or prefix; None matches all."""
    return asked is None or name.startswith(asked)


def standings(session: Session, track: str | None = None, suite: str | None = None) -> Iterator[Standings]:
    """Yield the standings of each set of comparable evaluations on the requested tracks and suites.

    A submission appears once, under its name, with its latest evaluation. A newer version replaces an older
    one even if it is worse, since it is its author's current choice.
    """
    wanted = (
        select(Evaluation)
        .options(joinedload(Evaluation.submission), selectinload(Evaluation.scores))
        .order_by(Evaluation.started, Evaluation.id)
    )
    # Sorting is stable: within a key the latest evaluation stays the last.
    found = [
        one for one in session.scalars(wanted) if is_meant(track, one.track) and is_meant(suite, one.suite)
    ]
    for key, group in groupby(sorted(found, key=_sort_key), _key):
        latest = {evaluation.submission.name: evaluation for evaluation in group}
        yield Standings(rows=tuple(rank(latest.values())), **dict(zip(CONDITIONS, key, strict=True)))


def tournaments(
    session: Session, track: str | None = None, suite: str | None = None
) -> list[models.Tournament]:
    """Return the latest tournament on each suite of each track, as far as requested."""
    latest: dict[tuple[str, str], models.Tournament] = {}
    for one in session.scalars(select(models.Tournament).order_by(models.Tournament.started)):
        if is_meant(track, one.track) and is_meant(suite, one.suite):
            latest[one.track, one.suite] = one
    return [latest[key] for key in sorted(latest)]


def _key(one: Evaluation) -> tuple[Any, ...]:
    return tuple(getattr(one, name) for name in CONDITIONS)


def _sort_key(one: Evaluation) -> tuple[int, tuple[Any, ...]]:
    """Return the sort key of the standings: the engine's order of the tracks, then the conditions."""
    from wildscav_engine.tracks import TRACKS

    tracks = list(TRACKS)
    return tracks.index(one.track) if one.track in tracks else len(tracks), _key(one)


def rank(evaluations: Iterable[Evaluation]) -> Iterator[Row]:
    """Yield evaluations from best to worst; those without a score come last and have no rank."""
    ordered = sorted(evaluations, key=lambda one: (_order(one), one.submission.name))
    place, before = 0, None
    for number, evaluation in enumerate(ordered, start=1):
        if not evaluation.scores:
            yield Row(None, evaluation)
            continue
        if evaluation.scores[0].mean != before:
            place, before = number, evaluation.scores[0].mean
        yield Row(place, evaluation)


def _order(evaluation: Evaluation) -> tuple[bool, float]:
    if not evaluation.scores:
        return True, 0.0
    score = evaluation.scores[0]
    return False, score.mean if score.lower_is_better else -score.mean


def document(one: Standings) -> dict[str, Any]:
    """Return the standings on one suite of one track as ``wildscav leaderboard --json`` prints them."""
    conditions = {name: getattr(one, name) for name in CONDITIONS}
    return conditions | {"limits": json.loads(one.limits), "rows": [_row(row) for row in one.rows]}


def _row(row: Row) -> dict[str, Any]:
    evaluation = row.evaluation
    return {
        "rank": row.rank,
        "submission": evaluation.submission.name,
        "version": evaluation.submission.version,
        "digest": evaluation.submission.digest,
        "started": evaluation.started.isoformat(),
        "key": evaluation.key,
        "matches": len(evaluation.matches),
        "faults": evaluation.faults,
        "scores": [
            MetricInfo.about(score).model_dump() | Summary.about(score).model_dump()
            for score in evaluation.scores
        ],
    }
