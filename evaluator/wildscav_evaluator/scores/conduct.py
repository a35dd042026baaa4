"""What to tell an author whose agent plays to the end, but not by the rules.

Fields that a track does not have are counted in the results and not told: an agent for several tracks may
well set them.
"""

from wildscav.console import counted
from wildscav.wire.actions import MAX_WALK_SPEED
from wildscav_evaluator.output.results import Evaluation


def evaluation_remark(evaluation: Evaluation) -> str | None:
    """Return a line on a submission's invalid actions on one track, if there were any."""
    seats = [seat for row in evaluation.matches for seat in row.seats]
    return remark(
        f"{evaluation.submission} on {evaluation.track}",
        actions=sum(seat.actions for seat in seats),
        invalid=sum(seat.invalid_actions for seat in seats),
    )


def remark(who: str, *, actions: int, invalid: int) -> str | None:
    """Return a line on an agent's invalid actions, if there were any.

    Args:
        who: Whose they are.
        actions: How many actions it sent in time.
        invalid: How many of them had a number out of its range.
    """
    if not invalid:
        return None
    return (
        f"{who}: {invalid:,} of {counted(actions, 'action')} {'was' if invalid == 1 else 'were'} invalid and "
        f"played as no action (walk_speed must be 0 to {MAX_WALK_SPEED:g} m/s, every angle a finite number)"
    )
