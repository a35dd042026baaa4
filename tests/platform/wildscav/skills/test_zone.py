"""The safe zone: when an agent has to set off for the next circle, and how it stands in its middle."""

import numpy as np
import pytest
from tests.platform.wildscav.skills.observations import seen

from wildscav.geometry import moved
from wildscav.skills.walking import hold
from wildscav.skills.zone import USUAL, Caution, safe_zone

EARLY = Caution(margin=10.0, pace=3.0, spare=15.0)


def reading(edge: float, next_east: float, shrunk_in: float) -> dict[str, np.ndarray]:
    """A zone of 100 m whose edge is ``edge`` metres west, and a next circle of 20 m in the east."""
    numbers = (1.0, edge, 100.0 - edge, 0.0, 100.0, next_east, 0.0, 20.0, 0.0, shrunk_in, 2.0)
    return {"zone": np.array(numbers, np.float32)}


@pytest.mark.parametrize(
    ("edge", "next_east", "shrunk_in", "caution", "safe"),
    [
        (7.0, 0.0, 100.0, USUAL, True),
        (7.0, 0.0, 100.0, EARLY, False),  # nearer to the edge than 10 m
        (50.0, 80.0, 20.0, USUAL, True),  # 60 m at 5 m/s and 2 s to spare: 14 s
        (50.0, 80.0, 20.0, EARLY, False),  # at 3 m/s and 15 s to spare: 35 s
        (50.0, 80.0, 36.0, EARLY, True),
    ],
)
def test_the_cautious_set_off_earlier(
    edge: float, next_east: float, shrunk_in: float, caution: Caution, safe: bool
) -> None:
    observation = seen(tensors=reading(edge, next_east, shrunk_in))

    assert safe_zone(observation, caution).is_safe(observation.position) is safe


def test_who_holds_a_place_walks_there_and_stops() -> None:
    place, here = (2.5, 0.0, 0.0), (0.0, 0.0, 0.0)
    speeds = []
    for _ in range(5):
        walk = hold(here, place, 0.1)
        speeds.append(round(walk.speed, 6))
        here = moved(here, walk.direction, walk.speed * 0.1)

    assert speeds == [10.0, 10.0, 5.0, 0.0, 0.0]
