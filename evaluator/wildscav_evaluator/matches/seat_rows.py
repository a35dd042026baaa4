"""Conversion of the match server's reports on a submission's seats to rows of the results file."""

from wildscav.server import SeatReport
from wildscav_evaluator.matches.jobs import Job
from wildscav_evaluator.matches.play import PlayedMatch
from wildscav_evaluator.output.results import FINISHED, MatchTiming, SeatRow, SeatTiming


def seat_row(job: Job, played: PlayedMatch, seat: int) -> SeatRow:
    """Return how a match went in an entrant's seat, as a row of the results file."""
    metrics = dict(played.match.result().seats[seat].metrics)
    entrant, team = _entrant_and_team(job, seat)
    if seat in job.robots:
        return SeatRow(seat=seat, submission=entrant, team=team, status=FINISHED, metrics=metrics)
    report, log = played.seats[seat], job.log(seat)
    return SeatRow(
        seat=seat,
        submission=entrant,
        team=team,
        status=report.status.value,
        fault=fault.value if (fault := report.status.fault) else None,
        detail=report.detail,
        exit_code=report.exit_code,
        killed_by=report.killed_by,
        last_lines=report.last_lines,
        actions=report.steps_played,
        invalid_actions=report.invalid_actions,
        ignored_fields=report.ignored_fields,
        metrics=metrics,
        log=log if (job.out / log).exists() else None,
    )


def _entrant_and_team(job: Job, seat: int) -> tuple[str | None, int | None]:
    """Return whose seat it is and its team; None in an evaluation, where every seat is the submission's."""
    return (None, None) if job.evaluated is not None else (job.entrants[seat], job.spec.team_of_seats[seat])


def match_timing(job: Job, played: PlayedMatch, started: float, wall: float) -> MatchTiming:
    """Return how long a match took, as an entry of the results file.

    Args:
        job: The job of the match.
        played: The match.
        started: When it started, in seconds since 1970, UTC.
        wall: How long it took, s, including the start of the agents and writing the record.
    """
    return MatchTiming(
        submission=job.evaluated,
        track=job.track,
        index=job.index,
        started=started,
        wall=wall,
        steps=played.match.step_number,
        seats=tuple(_seat_timing(played.seats[seat]) for seat in job.seats),
        platform_faults=played.platform_faults,
    )


def _seat_timing(report: SeatReport) -> SeatTiming:
    times = report.think_time
    return SeatTiming(
        seat=report.seat,
        start_up=report.start_up,
        steps=report.steps_played + report.late_steps,
        late_steps=report.late_steps,
        credited=report.credited,
        dropped_actions=report.dropped_actions,
        time_used=times.total,
        latency_p50=times.p50,
        latency_p99=times.p99,
        latency_max=times.max,
        time_bank=report.time_bank,
    )
