"""Whose fault late steps are: the agent's, or that of a machine that had no processor for it.

The clock of a match measures wall time, and where other programs keep the machine busy, an agent's time goes
by while it cannot run. So the answers that took longer than the budget are accounted for once more, without
the time that the agent waited for a processor. A late step is the platform's if it comes out in time then.
The match is not changed by it: its results say so.
"""

from collections.abc import Callable, Sequence

from wildscav.server import Clock, SlowAnswer

Waited = Callable[[float, float], float]  # s of waiting for a processor between two moments


def late_for_platform(
    late: Sequence[int], slow_answers: Sequence[SlowAnswer], clock: Clock, waited: Waited, *, used_up: bool
) -> tuple[int, ...]:
    """Return which late steps are the platform's fault.

    Args:
        late: Numbers of the steps that were played without an answer.
        slow_answers: The agent's answers that took longer than the budget, in order, with when they began.
        clock: Of the match.
        waited: How long the agent waited for a processor.
        used_up: Whether its own time bank was used up; else the match had no more time to wait.
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
