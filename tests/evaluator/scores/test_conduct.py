"""What an author is told of actions that were not as they must be."""

import pytest

from wildscav_evaluator.scores.conduct import remark


@pytest.mark.parametrize(
    ("actions", "invalid", "says"),
    [
        (1000, 1000, "me: 1,000 of 1,000 actions were invalid and played as no action"),
        (300, 1, "me: 1 of 300 actions was invalid"),
        (1, 1, "me: 1 of 1 action was invalid"),
    ],
)
def test_invalid_actions_are_told(actions: int, invalid: int, says: str) -> None:
    assert str(remark("me", actions=actions, invalid=invalid)).startswith(says)


def test_there_is_nothing_to_tell_of_valid_actions() -> None:
    assert remark("me", actions=300, invalid=0) is None
