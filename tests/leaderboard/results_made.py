"""Results of matches that nobody played, as an executor would bring them."""

from collections.abc import Sequence
from hashlib import blake2b

from tests.evaluator.results_by_hand import timing_of_a_seat

from wildscav_evaluator.output.results import MatchRow, MatchTiming, SeatRow, metric_infos
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
    timings = tuple(timing_of_a_seat(seat=one.seat) for one in seats)
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
