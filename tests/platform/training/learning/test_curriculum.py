"""The next stage begins when a whole window of episodes has been played, and 80 % of them were successes."""

import pytest

from wildscav_training.learning.curriculum import WINDOW, Curriculum


def test_without_stages_there_is_the_task_alone() -> None:
    curriculum = Curriculum()
    curriculum.record([1.0] * 2 * WINDOW)
    assert curriculum.start_range is None
    assert not curriculum.advance()


@pytest.mark.parametrize(
    ("successes", "failures", "advances"),
    [
        (WINDOW - 1, 0, False),  # all succeeded, but too few have ended
        (103, 25, True),  # 80.5 %
        (102, 26, False),  # 79.7 %
    ],
)
def test_a_stage_is_over_at_eighty_percent(successes: int, failures: int, advances: bool) -> None:
    curriculum = Curriculum((5.0, 20.0))
    curriculum.record([1.0] * successes + [0.0] * failures)
    assert curriculum.advance() == advances
    assert curriculum.start_range == (20.0 if advances else 5.0)


def test_old_episodes_are_forgotten_and_a_new_stage_starts_to_count_anew() -> None:
    curriculum = Curriculum((5.0,))
    curriculum.record([0.0] * WINDOW)
    curriculum.record([1.0] * WINDOW)
    assert curriculum.advance()
    assert curriculum.start_range is None
    assert curriculum.state() == {"stage": 1, "results": []}


def test_it_continues_from_its_state() -> None:
    before = Curriculum((5.0, 20.0))
    before.record([1.0] * WINDOW)
    before.advance()
    before.record([1.0] * (WINDOW - 1))
    after = Curriculum((5.0, 20.0))
    after.restore(before.state())
    after.record([1.0])
    assert after.advance()
    assert after.start_range is None
