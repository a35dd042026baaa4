"""Standings as ``wildscav leaderboard --json`` prints them."""

import json
from typing import Any

from wildscav_leaderboard.results.models import CONDITIONS
from wildscav_leaderboard.results.standings import Row, Standings


def document(one: Standings) -> dict[str, Any]:
    """Return the standings on one suite of one track as values of JSON's types."""
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
            {
                "name": score.name,
                "title": score.title,
                "unit": score.unit,
                "lower_is_better": score.lower_is_better,
                "mean": score.mean,
                "std": score.std,
                "low": score.low,
                "high": score.high,
            }
            for score in evaluation.scores
        ],
    }
