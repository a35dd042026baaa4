"""Notes for an author whose agent plays to the end, but sends invalid actions or is late.

Fields that a track does not have are counted in the results without a note, because an agent for several
tracks may set them.
"""

from collections.abc import Iterable, Sequence

from wildscav.terminal.console import counted
from wildscav.wire.actions import MAX_WALK_SPEED
from wildscav_evaluator.output.results import Evaluation, MatchTiming


def evaluation_actions_note(evaluation: Evaluation) -> str | None:
    """Return a line about a submission's invalid actions on one track, or None if there were none."""
    seats = [seat for row in evaluation.matches for seat in row.seats]
    return invalid_actions_note(
        f"{evaluation.submission} on {evaluation.track}",
        actions=sum(seat.actions for seat in seats),
        invalid=sum(seat.invalid_actions for seat in seats),
    )


def evaluation_waits_note(evaluation: Evaluation, timings: Iterable[MatchTiming]) -> str | None:
    """Return a line about a submission's waits for a processor; None if its banks paid for nothing of others.

    Args:
        evaluation: The evaluation of the submission on one track.
        timings: The timings of its matches.
    """
    credited = [seat.credited or 0.0 for timing in timings for seat in timing.seats]
    return waits_note(f"{evaluation.submission} on {evaluation.track}", credited)


def waits_note(who: str, credited: Sequence[float]) -> str | None:
    """Return a line about the waits for a processor that were credited; None if none were.

    Args:
        who: The name of the agent.
        credited: For each match and seat, s.
    """
    if not any(credited):
        return None
    return (
        f"{who}: the machine was so busy that the agent waited for a processor; its time banks did not pay "
        f"{sum(credited):.1f} s of that, at most {max(credited):.1f} s in a match"
    )


def invalid_actions_note(who: str, *, actions: int, invalid: int) -> str | None:
    """Return a line about an agent's invalid actions, or None if there were none.

    Args:
        who: The name of the agent.
        actions: How many actions it sent in time.
        invalid: How many of them had a number out of its range.
    """
    if not invalid:
        return None
    return (
        f"{who}: {invalid:,} of {counted(actions, 'action')} {'was' if invalid == 1 else 'were'} invalid and "
        f"played as no action (walk_speed must be 0 to {MAX_WALK_SPEED:g} m/s, every angle a finite number)"
    )
