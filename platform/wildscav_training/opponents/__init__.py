"""Submissions as opponents in training environments, in the same process, and an agent that knows the map.

    from wildscav_training.opponents import submission

    env = SingleEnv("battle", opponents=(submission("submissions/hunter"), "fighter"))

A submission's code runs with all rights of this process: use only submissions that you trust.
"""

from wildscav_training.opponents.oracle import Oracle
from wildscav_training.opponents.submission import SubmissionOpponent, submission

__all__ = ["Oracle", "SubmissionOpponent", "submission"]
