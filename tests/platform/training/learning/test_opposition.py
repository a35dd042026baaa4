"""Who plays against a policy in training, as a command names it."""

from typing import Any

import pytest
from tests.platform.training.learning.common import small

from wildscav.errors import UserError
from wildscav_training.learning.environment import make_env
from wildscav_training.learning.opposition import Opposition, fixed_opponents, read_opposition
from wildscav_training.opponents import SubmissionOpponent


def read(text: str, seats: int | None = None, *, easy_first: bool = False, **options: Any) -> Opposition:
    return read_opposition(text, "battle", {"agents": 1, **options}, seats, easy_first=easy_first)


def test_robots_submissions_and_the_policy_itself_are_told_apart() -> None:
    found = read("fighter, hunter,self")
    assert found == Opposition(("fighter", "hunter", "self"), seats=9)
    assert found.plays_itself
    assert found.robots == (("fighter",),)
    assert found.submissions == ("hunter",)
    assert read("fighter", agents=4).seats == 6, "ten seats in all"
    assert read("fighter", 2, agents=4).seats == 2


@pytest.mark.parametrize(
    ("name", "levels"),
    [
        ("fighter-easy", ("fighter-easy",)),
        ("fighter", ("fighter-easy", "fighter")),
        ("fighter-hard", ("fighter-easy", "fighter", "fighter-hard")),
        ("hunter-squad", ("hunter-squad-easy", "hunter-squad")),
    ],
)
def test_a_robot_may_begin_at_the_level_easy(name: str, levels: tuple[str, ...]) -> None:
    assert read(name, easy_first=True).robots == (levels,)
    assert read(name).robots == ((name,),)


def test_a_policy_is_measured_against_everybody_but_itself() -> None:
    fighter, hunter, again = fixed_opponents(read("self,fighter-hard,hunter", 3, easy_first=True))
    assert (fighter, again) == ("fighter-hard", "fighter-hard")
    assert isinstance(hunter, SubmissionOpponent)
    assert fixed_opponents(read("self", 2)) == ["fighter", "fighter"]
    env = make_env(small("battle", opposition=read("self,walker", 2)), 2, None, split="test")
    assert env.config.seats == ("submission", "walker", "walker")


@pytest.mark.parametrize(
    ("text", "options", "says"),
    [
        ("figther", {}, "there is no 'figther'; allowed are self, the folder or name of a submission, and"),
        ("fighter,fighter", {}, "must be different names separated by commas"),
        (" , ", {}, "must be different names separated by commas"),
        ("mapper", {}, "mapper"),  # it plays navigation alone
        ("self", {"agents": 10}, "10 learners leave no seat in battle; give --opponent-seats"),
    ],
)
def test_an_opponent_that_cannot_play_is_said(text: str, options: dict[str, Any], says: str) -> None:
    with pytest.raises(UserError) as caught:
        read(text, **options)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)
