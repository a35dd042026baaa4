"""Results of matches that nobody played, as an executor would bring them."""

from collections.abc import Sequence
from hashlib import blake2b

from wildscav_evaluator.output.results import MatchRow, MatchTiming, SeatRow, SeatTiming, metric_infos
from wildscav_leaderboard.matches.models import Match, MatchSeat
from wildscav_leaderboard.matches.service import PlayedRecord


def made_result(
    match: Match, seats: Sequence[MatchSeat], scores: Sequence[float]
) -> tuple[MatchRow, MatchTiming, PlayedRecord]:
    """Return the result of a match with a score for each of its seats."""
    rows = tuple(
        SeatRow(
            seat=one.seat,
            submission=one.entrant,
            status="finished",
            metrics={metric.name: score for metric in metric_infos(match.track)},
        )
        for one, score in zip(seats, scores, strict=True)
    )
    timings = tuple(
        SeatTiming(
            seat=one.seat,
            start_up=0.1,
            steps=40,
            late_steps=0,
            time_used=0.4,
            latency_p50=0.01,
            latency_p99=0.02,
            latency_max=0.03,
            time_bank=1.0,
        )
        for one in seats
    )
    row = MatchRow.of(match.number, rows, f"records/{match.track}-{match.number}.wsr")
    timing = MatchTiming(
        submission=None,
        track=match.track,
        index=match.number,
        started=0.0,
        wall=1.0,
        steps=40,
        seats=timings,
    )
    digest = blake2b(repr((match.id, tuple(scores))).encode(), digest_size=16).hexdigest()
    return row, timing, PlayedRecord(digest, 10_000)
