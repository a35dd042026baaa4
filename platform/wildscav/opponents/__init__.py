"""Submissions as opponents in training environments, in the same process.

    from wildscav.opponents import submission

    env = SingleEnv("battle", opponents=(submission("submissions/hunter"), "fighter"))

Its code runs with all rights of this process: use only submissions that you trust.
"""

from wildscav.opponents.submission import SubmissionOpponent, submission

__all__ = ["SubmissionOpponent", "submission"]
