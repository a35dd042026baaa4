"""Submissions as opponents in training environments, in the same process, and agents that know the target.

    from wildscav_training.opponents import submission

    env = SingleEnv("battle", opponents=(submission("submissions/hunter"), "fighter"))

A submission's code runs with all rights of this process: use only submissions that you trust.
"""

from pathlib import Path

from wildscav_engine.envs import SeatController
from wildscav_training.opponents.oracle import Oracle, Straight
from wildscav_training.opponents.submission import SubmissionOpponent, submission

__all__ = ["Oracle", "Straight", "SubmissionOpponent", "named_agent", "submission"]

YARDSTICKS: dict[str, type[SeatController]] = {"straight": Straight, "oracle": Oracle}  # no submissions


def named_agent(name: str) -> SeatController:
    """Return an agent: ``oracle``, ``straight``, the name of a baseline, or a submission's folder.

    Raises:
        UserError: There is no such agent.
    """
    if name in YARDSTICKS and not Path(name).exists():
        return YARDSTICKS[name]()
    return submission(name)
