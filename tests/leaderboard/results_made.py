"""Results of matches that nobody played, as an executor would bring them."""

from collections.abc import Sequence
from hashlib import blake2b

from tests.evaluator.results_by_hand import timing_of_a_seat

from wildscav_evaluator.output.results import MatchRow, MatchTiming, SeatRow, SeatTiming, metric_infos
from wildscav_leaderboard.matches.models import Match, MatchSeat
from wildscav_leaderboard.matches.service import PlayedRecord, Seat


def made_result(
    match: Match, seats: Sequence[MatchSeat | Seat], scores: Sequence[float], broken: str = ""
) -> tuple[MatchRow, MatchTiming, PlayedRecord]:
    """Return the result of a match: all metrics of a seat have its score, and one entrant may have broken."""
    rows = tuple(
        SeatRow(
            seat=one.seat,
            submission=one.entrant,
            status="crashed" if one.entrant == broken else "finished",
            fault="agent" if one.entrant == broken else None,
            metrics={metric.name: score for metric in metric_infos(match.track)},
        )
        for one, score in zip(seats, scores, strict=True)
    )
    row = MatchRow.of(match.number, rows, f"records/{match.track}-{match.number}.wsr")
    digest = blake2b(repr((match.id, tuple(scores))).encode(), digest_size=16).hexdigest()
    timing = made_timing(match, *(timing_of_a_seat(seat=one.seat) for one in seats))
    return row, timing, PlayedRecord(digest, 10_000)


def made_timing(match: Match, *seats: SeatTiming, entrant: str | None = None) -> MatchTiming:
    """Return how long a match took, with the timing of its seats, and whose it is if it is one's own."""
    return MatchTiming(
        submission=entrant,
        track=match.track,
        index=match.number,
        started=0.0,
        wall=1.0,
        steps=40,
        seats=seats,
    )
