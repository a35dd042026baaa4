"""House plans: properties of every plan that can be drawn."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.house import HousePlan, Side, Storey, draw_plan
from wildscav_engine.maps.house.furniture import ROOMS, SUBSTITUTES, overlap
from wildscav_engine.maps.house.plan import (
    DOOR_HEIGHT,
    DOOR_WIDTH,
    INNER_WALL,
    NARROWEST_ROOM,
    PASSAGE_WIDTH,
    WINDOW_SILL,
    WINDOW_TOP,
    Opening,
    Roof,
    Wall,
    part_of,
    shrunk,
    strip_at,
)
from wildscav_engine.maps.house.stairs import GOING, RISE, steps_of

OUTSIDE = -1
NEARLY = 1e-6


@st.composite
def plans(draw: st.DrawFn) -> HousePlan:
    fewest = draw(st.integers(1, 4))
    return draw_plan(
        draw(st.integers(0, 2**64 - 1)),
        draw(st.integers(0, 99)),
        (fewest, draw(st.integers(fewest, 4))),
        small=draw(st.booleans()),
    )


def is_within(inner: Rectangle, outer: Rectangle) -> bool:
    left, back, right, front = shrunk(outer, -NEARLY)
    return left <= inner.left and back <= inner.back and inner.right <= right and inner.front <= front


def beyond(area: Rectangle, side: Side, depth: float) -> Rectangle:
    """Return the strip outside a side of a rectangle."""
    left, back, right, front = strip_at(area, side, -depth)
    return Rectangle(min(left, right), min(back, front), max(left, right), max(back, front))


def sides_of(wall: Wall, opening: Opening, depth: float) -> list[Rectangle]:
    """Return the areas that must be free in front of and behind a doorway."""
    side = Side.FRONT if wall.is_across else Side.RIGHT
    hole = part_of(wall.outline, side, opening.start, opening.end)
    return [beyond(hole, outwards, depth) for outwards in (side, side.opposite)]


def doorways_of(storey: Storey) -> list[tuple[Wall, Opening]]:
    return [(wall, door) for wall in (*storey.outer, *storey.inner) for door in wall.doorways]


def rooms_joined(storey: Storey) -> list[tuple[int, int]]:
    """Return the rooms on both sides of each doorway."""
    joined = []
    for wall, door in doorways_of(storey):
        found = []
        for way in sides_of(wall, door, 0.1):
            rooms = [number for number, room in enumerate(storey.rooms) if overlap(way, room.area)]
            assert len(rooms) <= 1, "a doorway leads into two rooms at once"
            assert not rooms or is_within(way, storey.rooms[rooms[0]].area), "a wall ends in a doorway"
            found.append(rooms[0] if rooms else OUTSIDE)
        joined.append((found[0], found[1]))
    return joined


def insides(plan: HousePlan, level: int) -> list[Rectangle]:
    return [wing.inside for wing in plan.wings if level < wing.storeys]


@given(plans())
def test_rooms_fill_the_house_without_overlapping(plan: HousePlan) -> None:
    for level, storey in enumerate(plan.storeys):
        for number, room in enumerate(storey.rooms):
            assert any(is_within(room.area, inside) for inside in insides(plan, level))
            narrow = min(room.area.right - room.area.left, room.area.front - room.area.back)
            assert narrow >= (PASSAGE_WIDTH if room.purpose == "corridor" else NARROWEST_ROOM) - NEARLY
            for other in storey.rooms[:number]:
                assert not overlap(shrunk(room.area, -INNER_WALL), other.area)
        rooms = sum(room.area.area for room in storey.rooms)
        walls = sum(wall.outline.area for wall in storey.inner)
        assert rooms + walls == pytest.approx(sum(inside.area for inside in insides(plan, level)))


@given(plans())
def test_doorways_join_all_rooms_of_a_storey(plan: HousePlan) -> None:
    for level, storey in enumerate(plan.storeys):
        joined = rooms_joined(storey)
        reached = {OUTSIDE} if level == 0 else {[room.purpose for room in storey.rooms].index("hall")}
        for _ in storey.rooms:
            reached |= {room for pair in joined if reached & set(pair) for room in pair}
        assert reached - {OUTSIDE} == set(range(len(storey.rooms)))
        assert all(one != other for one, other in joined)
        if level == 0:
            assert sum(OUTSIDE in pair for pair in joined) == len(plan.doors)
        for _, door in doorways_of(storey):
            assert door.width == pytest.approx(DOOR_WIDTH)
            assert (door.bottom, door.top) == (0.0, DOOR_HEIGHT)


@given(plans())
def test_doorways_above_the_ground_lead_to_rooms_and_terraces_only(plan: HousePlan) -> None:
    for level, storey in enumerate(plan.storeys[1:], start=1):
        roofs = [
            plan.wings[number].outline for number in plan.terraces if plan.wings[number].storeys == level
        ]
        for wall, door in doorways_of(storey):
            for way in sides_of(wall, door, 0.1):
                assert any(is_within(way, place) for place in (*insides(plan, level), *roofs))


@given(plans())
def test_doorways_and_stairs_are_clear_of_stairs_and_furniture(plan: HousePlan) -> None:
    for level, storey in enumerate(plan.storeys):
        blocked = [piece.outline for piece in storey.furniture]
        stairs = [plan.stairs.well] if plan.stairs and (storey.stairs or storey.hole) else []
        for wall, door in doorways_of(storey):
            for way in sides_of(wall, door, PASSAGE_WIDTH):
                ways = [inside for inside in insides(plan, level) if overlap(way, inside)]
                for other in blocked + (stairs if ways else []):
                    assert not overlap(way, other)
        if plan.stairs:
            hall = next(room for room in storey.rooms if room.purpose == "hall")
            for piece in storey.furniture:
                if overlap(piece.outline, hall.area):
                    assert not overlap(piece.outline, shrunk(plan.stairs.well, -PASSAGE_WIDTH))


@given(plans())
def test_furniture_stands_in_rooms_and_apart(plan: HousePlan) -> None:
    for storey in plan.storeys:
        for number, piece in enumerate(storey.furniture):
            (room,) = [room for room in storey.rooms if overlap(room.area, piece.outline)]
            assert is_within(piece.outline, room.area)
            wanted = ROOMS[room.purpose]
            assert piece.name in (*wanted, *(SUBSTITUTES.get(name) for name in wanted))
            assert 1 <= len(piece.blocks) <= 2
            assert all(is_within(block.area, piece.outline) for block in piece.blocks)
            assert all(0.0 <= block.bottom < block.top < 2.3 for block in piece.blocks)
            assert not any(overlap(piece.outline, other.outline) for other in storey.furniture[:number])


def test_most_rooms_are_furnished() -> None:
    counts = [
        sum(overlap(room.area, piece.outline) for piece in storey.furniture)
        for seed in range(30)
        for storey in draw_plan(seed, 0, (1, 4)).storeys
        for room in storey.rooms
        if room.purpose not in ("hall", "corridor")
    ]

    assert max(counts) <= 4
    assert sum(count > 0 for count in counts) > 0.95 * len(counts)
    assert 1.5 < sum(counts) / len(counts) < 3.0


@given(plans())
def test_every_storey_has_windows_clear_of_doors_and_of_walls_behind_them(plan: HousePlan) -> None:
    for storey in plan.storeys:
        windows = 0
        for wall in storey.outer:
            for opening in wall.openings:
                if opening.is_doorway:
                    continue
                windows += 1
                assert (opening.bottom, opening.top) == (WINDOW_SILL, WINDOW_TOP)
                assert opening.width >= 0.75
                for way in sides_of(wall, opening, 0.05):
                    assert not any(overlap(way, wall.outline) for wall in (*storey.inner, *storey.outer))
                    if storey.stairs:
                        assert not overlap(way, storey.stairs.well)
            ends = [place for opening in wall.openings for place in (opening.start, opening.end)]
            assert ends == sorted(ends), "openings overlap"
        assert windows >= 2


@given(plans())
def test_stairs_lead_up_step_by_step_and_leave_room_at_both_ends(plan: HousePlan) -> None:
    assert (plan.stairs is not None) == (len(plan.storeys) > 1 or plan.roof_exit)
    if plan.stairs is None:
        return
    stairs = plan.stairs
    assert is_within(stairs.well, stairs.hall)
    assert is_within(stairs.hall, plan.wings[0].inside)
    heights = [height for flight in stairs.flights for _, height in steps_of(flight)]
    if stairs.landing:
        heights.insert(len(steps_of(stairs.flights[0])), 8 * RISE)
    assert heights == pytest.approx([RISE * (step + 1) for step in range(len(heights))])
    assert 3.0 - RISE - NEARLY <= heights[-1] <= 3.0 + NEARLY
    for flight in stairs.flights:
        across = flight.climbs.is_across
        wide, long = flight.outline.right - flight.outline.left, flight.outline.front - flight.outline.back
        assert (wide if across else long) == pytest.approx(PASSAGE_WIDTH)
        assert (long if across else wide) == pytest.approx(GOING * len(steps_of(flight)))
    first, last = stairs.flights[0], stairs.flights[-1]
    for end, side in ((first, first.climbs.opposite), (last, last.climbs)):
        assert is_within(beyond(end.outline, side, PASSAGE_WIDTH), stairs.hall)
    for storey in plan.storeys[1:]:
        assert storey.hole == stairs.well


@pytest.mark.parametrize("area", [(7.0, 7.0), (24.0, 24.0), (7.0, 24.0), (13.5, 9.25)])
@pytest.mark.parametrize("seed", range(5))
def test_a_house_fills_the_area_that_is_asked_for(seed: int, area: tuple[float, float]) -> None:
    plan = draw_plan(seed, 0, (1, 4), area=area)
    outlines = [wing.outline for wing in plan.wings]

    assert plan.size == area
    assert max(outline.right for outline in outlines) == pytest.approx(area[0] / 2.0)
    assert min(outline.left for outline in outlines) == pytest.approx(-area[0] / 2.0)
    assert max(outline.front for outline in outlines) == pytest.approx(area[1] / 2.0)
    assert min(outline.back for outline in outlines) == pytest.approx(-area[1] / 2.0)


@pytest.mark.parametrize("area", [(6.9, 10.0), (10.0, 24.1), (float("nan"), 10.0)])
def test_a_house_of_an_impossible_area_is_refused(area: tuple[float, float]) -> None:
    with pytest.raises(MapError, match=r"area is .* a house takes 7.0 to 24.0 m a side"):
        draw_plan(0, 0, (1, 2), area=area)


def test_houses_differ_and_can_be_drawn_again() -> None:
    drawn = [draw_plan(0, number, (1, 4)) for number in range(20)]

    assert drawn == [draw_plan(0, number, (1, 4)) for number in range(20)]
    assert len(set(drawn)) == 20
    assert draw_plan(1, 0, (1, 4)) != drawn[0]


def test_all_kinds_of_houses_are_drawn() -> None:
    drawn = [draw_plan(seed, 0, (1, 4)) for seed in range(80)]

    assert {len(plan.storeys) for plan in drawn} == {1, 2, 3, 4}
    assert {wing.roof for plan in drawn for wing in plan.wings} == set(Roof)
    assert {wing.joint for plan in drawn for wing in plan.wings} == {None, *Side}
    assert {plan.style for plan in drawn} == {"dwelling", "store", "office"}
    shapes = [(len(plan.wings), plan.wings[-1].storeys < plan.wings[0].storeys) for plan in drawn]
    for shape in ((1, False), (2, False), (2, True)):
        assert shapes.count(shape) >= 8
    assert 8 <= sum(plan.roof_exit or bool(plan.terraces) for plan in drawn) <= 60
    assert {plan.stairs.landing is None for plan in drawn if plan.stairs} == {True, False}
    for across, along in (plan.size for plan in drawn):
        assert 8.0 <= min(across, along) <= max(across, along) <= 18.0


def test_large_houses_have_a_second_door_on_another_side() -> None:
    doors = set()
    for seed in range(40):
        plan = draw_plan(seed, 0, (1, 4))
        large = sum(wing.outline.area for wing in plan.wings) >= 120.0
        assert len(plan.doors) == 1 + large
        assert plan.doors[0].facing is Side.FRONT
        assert len({door.facing for door in plan.doors}) == len(plan.doors) or len(plan.wings) == 2
        doors.add(len(plan.doors))

    assert doors == {1, 2}
