"""Notes for an author whose agent plays to the end, but sends invalid actions or is late.

Fields that a track does not have are counted in the results without a note, because an agent for several
tracks may set them.
"""

from collections.abc import Iterable, Mapping, Sequence

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


def evaluation_lateness_note(evaluation: Evaluation, timings: Iterable[MatchTiming]) -> str | None:
    """Return a line about a submission's late steps that are the machine's fault; None if there are none.

    Args:
        evaluation: The evaluation of the submission on one track.
        timings: The timings of its matches.
    """
    late: dict[str, Sequence[int]] = {}
    for timing in timings:
        for seat in timing.seats:
            if seat.late_for_platform:
                where = f", seat {seat.seat}" if len(timing.seats) > 1 else ""
                late[f"match {timing.index}{where}: "] = seat.late_for_platform
    return lateness_note(f"{evaluation.submission} on {evaluation.track}", late) if late else None


def lateness_note(who: str, late: Mapping[str, Sequence[int]]) -> str:
    """Return a line about late steps that are the machine's fault.

    Args:
        who: The name of the agent.
        late: The numbers of the steps, from 0 as in the results, by the text to write before them.
    """
    count = sum(map(len, late.values()))
    where = "; ".join(f"{before}{_ranges(steps)}" for before, steps in late.items())
    return (
        f"{who}: {counted(count, 'late step')} {'was' if count == 1 else 'were'} the machine's fault, which "
        f"was so busy that the agent waited for a processor ({where})"
    )


def _ranges(steps: Sequence[int]) -> str:
    """Return the numbers of steps, given from 0, as text that counts from 1, such as "steps 3, 7–9"."""
    ranges: list[list[int]] = []
    for step in sorted(number + 1 for number in steps):
        if ranges and step == ranges[-1][-1] + 1:
            ranges[-1][1:] = [step]
        else:
            ranges.append([step])
    words = ["–".join(map(str, one)) for one in ranges]
    return f"{'step' if len(steps) == 1 else 'steps'} {', '.join(words)}"


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
