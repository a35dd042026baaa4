"""Boxes that cannot be reached are left alone, for a while."""

from tests.platform.wildscav.skills.observations import match_info, seen

from wildscav import SupplyBox
from wildscav.skills.patience import LEFT_ALONE, PATIENCE, Patience

UPSTAIRS = SupplyBox(id=3, position=(2.0, 3.0, 0.0), quantity=10)
FAR = SupplyBox(id=4, position=(15.0, 0.0, 0.0), quantity=10)
STEP = 0.1  # s


def stay(patience: Patience, start: float, seconds: float) -> list[tuple[SupplyBox, ...]]:
    steps = range(round(seconds / STEP))
    return [patience.boxes(seen(time=start + STEP * step, supply_boxes=(UPSTAIRS, FAR))) for step in steps]


def test_a_box_that_stays_near_is_left_alone_and_a_far_one_is_not() -> None:
    shown = stay(Patience(match_info()), 0.0, 10.0)
    assert set(shown[: round(0.9 * PATIENCE / STEP)]) == {(UPSTAIRS, FAR)}
    assert set(shown[round(1.1 * PATIENCE / STEP) :]) == {(FAR,)}


def test_it_is_tried_again_later() -> None:
    patience = Patience(match_info())
    stay(patience, 0.0, PATIENCE + 2 * STEP)
    away = seen(time=PATIENCE + LEFT_ALONE + 1.0, position=(9.0, 0.0, 0.0), supply_boxes=(UPSTAIRS,))
    assert patience.boxes(away) == (UPSTAIRS,)


def test_passing_by_a_few_times_counts_together() -> None:
    patience = Patience(match_info())
    for start in (0.0, 50.0):
        assert stay(patience, start, 0.6 * PATIENCE)[0] == (UPSTAIRS, FAR)
    assert stay(patience, 60.0, STEP) == [(FAR,)]
