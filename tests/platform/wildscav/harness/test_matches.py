"""A scripted model plays a whole match of a real server, by the texts and tools of a seat."""

from pathlib import Path

from tests.platform.helpers.seats import small_spec
from tests.platform.wildscav.harness.model_matches import model_match
from tests.scripted_mind import mind
from tests.scripted_model import Answer, Failed, Reset, cut, disturbed, said

from wildscav.harness.spending import Ending
from wildscav_engine.record import read_record, verify_record

DISTURBANCES: dict[int, Answer] = {0: Failed(500), 1: said("Where am I?"), 2: cut("go"), 3: Reset()}


def test_a_navigation_is_played_in_spite_of_all_disturbances(tmp_path: Path) -> None:
    spec = small_spec("navigation", seconds=30.0, clock="paused")

    course, result, record = model_match(spec, disturbed(mind, DISTURBANCES), tmp_path, pause=0.0)

    assert result.seats[0].metrics["success"] == 1.0
    assert (course.ending, course.spending.failures) == (Ending.MATCH_OVER, 2)
    assert course.spending.without_call == 2
    assert verify_record(read_record(record)).holds
