"""Following a submission through its states, whatever happens to the connection meanwhile."""

import time
from collections.abc import Iterator

from wildscav.errors import UserError
from wildscav_leaderboard.api.documents import SubmissionView
from wildscav_leaderboard.client.errors import AnswerError, UnreachableError
from wildscav_leaderboard.client.season import SeasonClient
from wildscav_leaderboard.submissions.states import ACTIVE, FINAL

PAUSE = 1.0  # s between two questions
PATIENCE = 900.0  # s without an answer


def follow(client: SeasonClient, submission: SubmissionView) -> Iterator[SubmissionView | UserError]:
    """Yield what becomes of a submission, until it has ended; an error where the season did not answer.

    Raises:
        UserError: The season refuses, or has not answered for a long time.
    """
    answered = time.monotonic()
    yield submission
    while submission.state not in (ACTIVE, *FINAL):
        time.sleep(PAUSE)
        try:
            submission = client.submission(submission.id)
        except UserError as error:
            if not _passes(error) or time.monotonic() - answered > PATIENCE:
                raise
            yield error
        else:
            answered = time.monotonic()
            yield submission


def _passes(error: UserError) -> bool:
    """Return whether it is worth to ask again."""
    return isinstance(error, UnreachableError) or (isinstance(error, AnswerError) and error.is_passing)
