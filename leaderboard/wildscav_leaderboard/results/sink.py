"""The result sink that stores the results of ``wildscav evaluate`` in the database."""

import json
from datetime import datetime
from hashlib import blake2b
from pathlib import Path
from typing import Any

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from wildscav.terminal.console import counted
from wildscav_evaluator.output import results
from wildscav_evaluator.tournaments.tournament_file import Tournament
from wildscav_leaderboard.results import models
from wildscav_leaderboard.results.database import check_writable, writing
from wildscav_leaderboard.results.models import Evaluation, MatchResult, Score, Submission


class DatabaseSink:
    """Stores evaluations. An evaluation that is stored again replaces the previous one."""

    def __init__(self, path: str) -> None:
        self._path = Path(path)

    def check(self) -> None:
        """Check that the database can be written, without creating a missing one.

        Raises:
            UserError: It cannot be written, or is not a leaderboard's.
        """
        check_writable(self._path)

    def store_tournament(self, tournament: Tournament, played: results.Results) -> str:
        """Store the ratings of a tournament, or nothing, and return a line that says where.

        Raises:
            UserError: The database cannot be written.
        """
        with writing(self._path) as session:
            session.execute(delete(models.Tournament).filter_by(identity=_identity(tournament)))
            session.add(
                models.Tournament(
                    identity=_identity(tournament),
                    track=tournament.track,
                    suite=tournament.suite,
                    started=datetime.fromisoformat(played.timings.started),
                    key=played.key,
                    document=tournament.as_json(),
                )
            )
        return f"the ratings are in the database {self._path}"

    def store(self, evaluations: results.Results) -> str:
        """Store all evaluations, or none, and return a line that says where.

        Raises:
            UserError: The database cannot be written.
        """
        with writing(self._path) as session:
            for evaluation in evaluations.evaluations:
                _store(session, evaluations, evaluation)
        count = len(evaluations.evaluations)
        return f"{counted(count, 'evaluation')} {'is' if count == 1 else 'are'} in the database {self._path}"


def _identity(tournament: Tournament) -> str:
    """Return a digest of everything that a tournament depends on, 32 hexadecimal digits."""
    parts = {"versions", "track", "suite", "seed", "rounds", "settings", "sandbox", "limits"}
    entrants = [(one.name, one.version, one.digest) for one in tournament.entrants]
    text = json.dumps([tournament.model_dump(mode="json", include=parts), entrants], sort_keys=True)
    return blake2b(text.encode(), digest_size=16).hexdigest()


def _store(session: Session, whole: results.Results, evaluation: results.Evaluation) -> None:
    submission, conditions = _submission(session, evaluation), _conditions(whole, evaluation.track)
    old = session.scalars(select(Evaluation).filter_by(submission=submission, **conditions)).one_or_none()
    if old is not None:
        session.delete(old)
        session.flush()
    session.add(
        Evaluation(
            submission=submission,
            **conditions,
            started=datetime.fromisoformat(whole.timings.started),
            faults=evaluation.faults,
            key=whole.key,
            scores=_scores(evaluation),
            matches=_matches(evaluation),
        )
    )
    session.flush()


def _conditions(whole: results.Results, track: str) -> dict[str, Any]:
    """Return everything that an evaluation depends on besides its submission."""
    limits = whole.limits.get(track, results.KeptLimits())
    return {
        "track": track,
        "suite": whole.suite,
        "seed": whole.seed_label,
        "engine_version": whole.versions.engine,
        "simulation_version": whole.versions.simulation,
        "generator_version": whole.versions.generator,
        "record_version": whole.versions.record,
        "sandbox": whole.sandbox,
        "limits": limits.model_dump_json(exclude_none=True),
    }


def _submission(session: Session, evaluation: results.Evaluation) -> Submission:
    """Return the submission's row, which is created at its first evaluation."""
    own: dict[str, Any] = {
        "name": evaluation.submission,
        "version": evaluation.version,
        "digest": evaluation.digest,
    }
    known = session.scalars(select(Submission).filter_by(**own)).one_or_none()
    if known is not None:
        return known
    new = Submission(**own)
    session.add(new)
    session.flush()
    return new


def _scores(evaluation: results.Evaluation) -> list[Score]:
    return [
        Score(
            position=position,
            **metric.model_dump(),
            **evaluation.summary[metric.name].model_dump(),
        )
        for position, metric in enumerate(evaluation.metrics)
        if metric.name in evaluation.summary
    ]


def _matches(evaluation: results.Evaluation) -> list[MatchResult]:
    return [
        MatchResult(
            index=row.index, status=row.status, fault=row.fault, detail=row.detail, metrics=row.metrics
        )
        for row in evaluation.matches
    ]
