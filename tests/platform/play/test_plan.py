"""Which matches can be asked for."""

from pathlib import Path

import pytest

from wildscav.errors import UserError
from wildscav.play.plan import make_plan

HOMING = Path(__file__).parents[3] / "submissions" / "homing"


def test_the_person_has_the_first_seat_and_plays_fifty_steps_a_second() -> None:
    plan = make_plan("battle", None, 4, ["fighter-easy", "gatherer", "gatherer"], 30.0)
    assert plan.spec.seats == ("submission", "fighter-easy", "gatherer", "gatherer")
    assert plan.names == ("person", "fighter-easy", "gatherer 1", "gatherer 2")
    assert plan.spec.frames_per_action == 1
    assert plan.spec.time_limit == 30.0


def test_each_track_has_opponents_that_suit_it() -> None:
    assert make_plan("navigation", None, 0, None, None).spec.seats == ("submission",)
    assert len(make_plan("battle", None, 0, None, None).spec.seats) == 4
    assert make_plan("royale", None, 0, None, None).spec.time_limit == 300.0


def test_the_next_match_has_the_next_seed_on_the_same_map() -> None:
    plan = make_plan("navigation", 101, 2**64 - 1, None, None)
    assert plan.played(0) == plan.spec
    assert plan.played(1).seed == 0
    assert plan.played(1).map == plan.spec.map


def test_a_submission_has_a_seat_with_its_sensors() -> None:
    plan = make_plan("navigation", None, 0, [str(HOMING), "seeker"], None)
    assert plan.spec.seats == ("submission", "submission", "seeker")
    assert plan.names == ("person", "homing", "seeker")
    assert plan.opponents[0].folder == HOMING
    assert not plan.against_robots  # it needs its time, so the match cannot be paused


@pytest.mark.parametrize(
    ("track", "map_id", "opponents", "message"),
    [
        ("chess", None, None, "--track is 'chess'; the tracks are navigation, "),
        ("battle", 1000, None, "id is 1000; maps have the ids 1 to 999"),
        ("battle", None, ["figher"], "neither a robot .* nor a folder .*did you mean 'fighter'"),
        ("battle", None, [str(HOMING.parent)], "cannot read .*submission.toml"),
        ("navigation", None, [str(HOMING.parent / "commando")], "commando does not play navigation"),
    ],
)
def test_what_is_not_possible_is_said(
    track: str, map_id: int | None, opponents: list[str] | None, message: str
) -> None:
    with pytest.raises(UserError, match=message):
        make_plan(track, map_id, 0, opponents, None)
