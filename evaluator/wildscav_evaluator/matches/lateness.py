"""Whose fault late steps are: the agent's, or that of a machine that had no processor for it.

The clock of a match measures wall time, so an agent's time passes even while other programs keep the
processors busy and it cannot run. Answers that took longer than the budget are therefore accounted again,
without the time that the agent waited for a processor. If a late step would then have been in time, it is the
platform's fault. This does not change the match; it is only noted in the results.
"""

from collections.abc import Callable, Sequence

from wildscav.server import Clock, SlowAnswer

Waited = Callable[[float, float], float]  # seconds of waiting for a processor between two moments


def late_for_platform(
    late: Sequence[int], slow_answers: Sequence[SlowAnswer], clock: Clock, waited: Waited, *, used_up: bool
) -> tuple[int, ...]:
    """Return which late steps are the platform's fault.

    Args:
        late: Numbers of the steps that were played without an answer.
        slow_answers: The agent's answers that took longer than the budget, in order, with their times.
        clock: The clock of the match.
        waited: Returns how long the agent waited for a processor between two moments.
        used_up: Whether the agent used up its own time bank; otherwise the match had no more time to wait.
    """
    bank, excused = clock.time_bank, list[int]()
    for number, answer in enumerate(slow_answers):
        following = slow_answers[number + 1].step if number + 1 < len(slow_answers) else None
        steps = [step for step in late if answer.step <= step and (following is None or step < following)]
        wanted = answer.answered - answer.asked - waited(answer.asked, answer.answered)
        over = max(0.0, wanted - clock.step_budget)
        in_time = over <= (bank if used_up else 0.0)
        bank = max(0.0, bank - over)
        if in_time:
            excused += steps
    return tuple(excused)
