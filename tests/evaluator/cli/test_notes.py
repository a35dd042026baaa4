"""What an author is told of invalid actions, and of waits for a processor."""

import pytest
from tests.evaluator.results_by_hand import results_of, timing_of_a_seat

from wildscav_evaluator.cli.result_tables import evaluation_waits_note, invalid_actions_note


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


def test_what_waits_for_a_processor_did_not_cost_is_told() -> None:
    results = results_of("ann")
    seats = tuple(
        timing_of_a_seat().model_copy(update={"seat": seat, "credited": seconds})
        for seat, seconds in ((0, 1.25), (1, None), (2, 3.0))
    )
    timing = results.timings.matches[0].model_copy(update={"seats": seats})

    line = evaluation_waits_note(results.evaluations[0], [timing])

    assert str(line).startswith("ann on navigation: the machine was so busy")
    assert str(line).endswith("its time banks did not pay 4.2 s of that, at most 3.0 s in a match")


def test_there_is_nothing_to_tell_where_the_machine_kept_nobody_waiting() -> None:
    results = results_of("ann")
    assert evaluation_waits_note(results.evaluations[0], results.timings.matches) is None
