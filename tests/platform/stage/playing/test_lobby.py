"""What people may be called, and who plays for whom."""

import pytest
from tests.platform.stage.playing.tables import small_plan

from wildscav_stage.playing.links import Links
from wildscav_stage.playing.lobby import Lobby, LobbyError


def lobby() -> Lobby:
    return Lobby(small_plan("battle", opponents=("fighter-easy",), people=3), Links(3))


@pytest.mark.parametrize(
    ("text", "name"),
    [("Ada", "Ada"), ("  Ada \t Byron ", "Ada Byron"), ("Zoe\u0308", "Zoë"), ("艾达", "艾达")],
)
def test_a_name_is_taken_in_its_usual_form(text: str, name: str) -> None:
    people = lobby()
    people.rename(1, text)
    assert people.seats[1].describe()["name"] == name
    assert people.names(absent=()) == ("person 1", name, "person 3", "fighter-easy")


@pytest.mark.parametrize("text", ["", "   ", "x" * 21, "a\u202eb", "a\x00b", "\ud800"])
def test_what_cannot_be_shown_is_no_name(text: str) -> None:
    with pytest.raises(LobbyError, match="1 to 20 visible characters"):
        lobby().rename(1, text)


@pytest.mark.parametrize("text", ["person 1", "Person 3", "FIGHTER-EASY"])
def test_nobody_takes_the_name_of_another(text: str) -> None:
    with pytest.raises(LobbyError, match="somebody else is called"):
        lobby().rename(1, text)


def test_a_robot_that_plays_for_somebody_has_its_own_name() -> None:
    assert lobby().names(absent=[1]) == ("person 1", "fighter-easy 1", "person 3", "fighter-easy 2")


@pytest.mark.parametrize(("present", "most"), [(1, 8), (10, 10)])
def test_the_host_chooses_eight_robots_at_most_unless_more_are_there(present: int, most: int) -> None:
    people = Lobby(small_plan("battle", opponents=("walker",) * present), Links(1))

    people.arrange(0, ["fighter"] * most, new_map=True)
    with pytest.raises(LobbyError, match=f"at most {most} robots can play"):
        people.arrange(0, ["fighter"] * (most + 1), new_map=True)

    assert people.begin().robots == ("fighter",) * most
