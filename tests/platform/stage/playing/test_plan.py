"""Which matches can be asked for."""

from pathlib import Path

import pytest

from wildscav.errors import UserError
from wildscav_engine.specs.rules import NAMED
from wildscav_server.hosting.opponents import numbered
from wildscav_stage.playing.plan import make_plan

HOMING = Path(__file__).parents[4] / "submissions" / "homing"
READER = HOMING.parents[1] / "benchmarks" / "strength" / "reader"


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
    assert not plan.may_pause  # it needs its time, so the match cannot be paused


def test_submissions_come_before_robots_which_the_host_may_change() -> None:
    plan = make_plan("navigation", 101, 0, ["seeker", str(HOMING)], None)
    assert plan.names == ("person", "homing", "seeker")
    changed = plan.arranged(["walker", "walker"], new_map=True)
    assert changed.names == ("person", "homing", "walker 1", "walker 2")
    assert changed.spec.seats == ("submission", "submission", "walker", "walker")
    assert changed.submissions == plan.submissions
    assert changed.spec.map.config == plan.spec.map.config  # another map of the same kind
    assert changed.spec.map.seed == plan.spec.map.seed + 1
    assert plan.arranged(["seeker"], new_map=False) == plan


def test_an_arrangement_that_is_no_match_is_refused() -> None:
    with pytest.raises(UserError, match="such a match is not possible: seats"):
        make_plan("battle", None, 3, (), None).arranged(["fighter"] * 10_000, new_map=False)


def test_people_have_the_first_seats_and_robots_the_rest() -> None:
    plan = make_plan("battle", None, 0, None, None, people=3)
    assert plan.spec.seats == ("submission", "submission", "submission", "fighter-easy")
    assert plan.names == ("person 1", "person 2", "person 3", "fighter-easy")
    assert not plan.may_pause
    assert make_plan("battle", None, 0, None, None, people=6).spec.seats == ("submission",) * 6
    assert make_plan("battle", None, 0, ["fighter"], None, people=2).spec.seats[2:] == ("fighter",)


def test_a_robot_plays_for_each_person_who_is_not_here() -> None:
    plan = make_plan("navigation", None, 0, ["walker"], None, people=3)
    assert plan.played(0, absent=[1]).seats == ("submission", "seeker-easy", "submission", "walker")


@pytest.mark.parametrize(
    ("names", "numbered_names"),
    [
        (["a", "b"], ("a", "b")),
        (["a", "b", "a"], ("a 1", "b", "a 2")),
        (["a", "a 1", "a"], ("a 2", "a 1", "a 3")),  # somebody has that name already
    ],
)
def test_no_two_seats_have_the_same_name(names: list[str], numbered_names: tuple[str, ...]) -> None:
    assert numbered(names) == numbered_names


def test_people_may_play_by_fair_rules() -> None:
    plan = make_plan("battle", None, 0, None, None, rules="fair")
    assert plan.spec.rules == NAMED["fair"]
    with pytest.raises(UserError, match="no rules are called 'unfair'; allowed are original, fair"):
        make_plan("battle", None, 0, None, None, rules="unfair")


@pytest.mark.parametrize(
    ("track", "map_id", "opponents", "message"),
    [
        ("chess", None, None, "--track is 'chess'; the tracks are navigation, "),
        ("battle", 1000, None, "id is 1000; maps have the ids 1 to 999"),
        ("battle", None, ["figher"], "neither a robot .* nor a folder .*did you mean 'fighter'"),
        ("battle", None, [str(HOMING.parent)], "cannot read .*submission.toml"),
        ("navigation", None, [str(HOMING.parent / "commando")], "commando does not play navigation"),
        ("navigation", None, [str(READER)], "interface: is 'words'; here, agents must play by numbers"),
    ],
)
def test_what_is_not_possible_is_said(
    track: str, map_id: int | None, opponents: list[str] | None, message: str
) -> None:
    with pytest.raises(UserError, match=message):
        make_plan(track, map_id, 0, opponents, None)
