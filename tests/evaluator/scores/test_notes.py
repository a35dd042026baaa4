"""What an author is told of invalid actions, and of late steps that were the machine's fault."""

import pytest
from tests.evaluator.results_by_hand import results_of, timing_of_a_seat

from wildscav_evaluator.scores.notes import evaluation_lateness_note, invalid_actions_note


@pytest.mark.parametrize(
    ("actions", "invalid", "says"),
    [
        (1000, 1000, "me: 1,000 of 1,000 actions were invalid and played as no action"),
        (300, 1, "me: 1 of 300 actions was invalid"),
        (1, 1, "me: 1 of 1 action was invalid"),
    ],
)
def test_invalid_actions_are_told(actions: int, invalid: int, says: str) -> None:
    assert str(invalid_actions_note("me", actions=actions, invalid=invalid)).startswith(says)


def test_there_is_nothing_to_tell_of_valid_actions() -> None:
    assert invalid_actions_note("me", actions=300, invalid=0) is None


def test_late_steps_of_all_seats_of_a_match_are_told() -> None:
    results = results_of("ann")
    seats = tuple(
        timing_of_a_seat().model_copy(update={"seat": seat, "late_for_platform": steps})
        for seat, steps in ((0, (4, 5)), (2, (7,)))
    )
    timing = results.timings.matches[0].model_copy(update={"seats": seats})

    line = evaluation_lateness_note(results.evaluations[0], [timing])

    assert str(line).startswith("ann on navigation: 3 late steps were the machine's fault")
    assert "(match 0, seat 0: steps 5–6; match 0, seat 2: step 8)" in str(line)


def test_there_is_nothing_to_tell_where_the_machine_kept_nobody_waiting() -> None:
    results = results_of("ann")
    assert evaluation_lateness_note(results.evaluations[0], results.timings.matches) is None
