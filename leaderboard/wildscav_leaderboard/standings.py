"""Standings: who leads on a track, by the latest evaluation of every submission."""

from collections.abc import Iterable, Iterator
from itertools import groupby
from typing import Any, NamedTuple

from sqlalchemy import select
from sqlalchemy.orm import Session, joinedload, selectinload

from wildscav_leaderboard.models import CONDITIONS, Evaluation


class Row(NamedTuple):
    """One submission's place."""

    rank: int | None  # 1 leads; equal scores share a rank; none without a score
    evaluation: Evaluation


class Standings(NamedTuple):
    """The order on one suite of one track, of evaluations that can be compared.

    Only those of one seed on one version of the engine, its rules, its map generator and its records played
    the same matches, and only in one sandbox with one set of limits did their agents have the same means.
    """

    track: str
    suite: str
    seed: str
    engine_version: str
    simulation_version: int  # 0 of evaluations that were stored before it was; the next two as well
    generator_version: int
    record_version: int
    sandbox: str
    limits: str  # that it kept, as JSON
    rows: tuple[Row, ...]


def is_meant(asked: str | None, name: str) -> bool:
    """Return whether a track or suite is the one that is asked for: by its name, or by how that begins."""
    return asked is None or name.startswith(asked)


def standings(session: Session, track: str | None = None, suite: str | None = None) -> Iterator[Standings]:
    """Yield the standings of all that can be compared, or of the tracks and suites that are meant.

    A submission stands there once, under its name, with its latest evaluation: a newer version replaces an
    older one even if it is worse, since it is the one that its author stands by.
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
    for key, group in groupby(sorted(found, key=_place_of), _key):
        latest = {evaluation.submission.name: evaluation for evaluation in group}
        yield Standings(rows=tuple(rank(latest.values())), **dict(zip(CONDITIONS, key, strict=True)))


def _key(one: Evaluation) -> tuple[Any, ...]:
    return tuple(getattr(one, name) for name in CONDITIONS)


def _place_of(one: Evaluation) -> tuple[int, tuple[Any, ...]]:
    """Return what the standings are ordered by: the tracks as the engine lists them."""
    from wildscav_engine.tracks import TRACKS

    tracks = list(TRACKS)
    return tracks.index(one.track) if one.track in tracks else len(tracks), _key(one)


def rank(evaluations: Iterable[Evaluation]) -> Iterator[Row]:
    """Yield evaluations from first to last; those without a score come last and have no rank."""
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
