"""What a house is like inside: drawn in its own axes, before anything is built.

A house's own axes are *across* (to the right, seen from its middle towards its front) and *along* (towards
its front); heights count from its ground floor. Flights of stairs run along the two side walls, by turns on
the left and on the right, so that no flight lies right above another and all can be walked.
"""

from typing import NamedTuple

from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.rng import Dice, Stream

STOREY_HEIGHT = 3.0  # m, from floor to floor
SLAB = 0.2  # m, thickness of floors
OUTER_WALL, INNER_WALL = 0.25, 0.15  # m, thickness
DOOR_WIDTH, DOOR_HEIGHT = 1.3, 2.3  # m, clear
WINDOW_SILL, WINDOW_TOP = 1.0, 2.2  # m above the floor
PILLAR = 0.2  # m, least wall between a window and what is beside it
WINDOW_BAY = 2.7  # m of wall for each window, about
STEPS, RISE, GOING = 15, 0.2, 0.28  # of a flight; the last step is the upper floor
STAIR_WIDTH = 1.5  # m
LANDING = 1.2  # m, free at both ends of a flight
HOLE_LEAD = 0.6  # m that the hole over a flight begins before its first step, for head room
LARGE_HOUSE = 95.0  # m², from which on there is a back door
FLIGHT_LENGTH = (STEPS - 1) * GOING


class Opening(NamedTuple):
    """A doorway or window in a wall."""

    middle: float  # m, on the axis that the wall runs on
    width: float  # m
    bottom: float  # m above the floor
    top: float  # m above the floor

    @property
    def is_doorway(self) -> bool:
        """Whether it reaches down to the floor."""
        return self.bottom == 0.0


class Wall(NamedTuple):
    """A straight wall from floor to ceiling."""

    outline: Rectangle
    is_across: bool  # whether it runs across, else along
    openings: tuple[Opening, ...]  # ascending


class Flight(NamedTuple):
    """A straight flight of stairs to the storey above."""

    outline: Rectangle
    climb: int  # 1: upwards to the front, -1: to the back


class Storey(NamedTuple):
    """One storey: its walls, and the stairs that leave it."""

    outer: tuple[Wall, ...]
    inner: tuple[Wall, ...]
    flight: Flight | None  # up to the next storey
    hole: Rectangle | None  # in its floor, where stairs come up


class HousePlan(NamedTuple):
    """A whole house."""

    size: tuple[float, float]  # m, across and along
    storeys: tuple[Storey, ...]
    gable: bool  # whether the roof is pitched, else flat

    @property
    def room(self) -> Rectangle:
        """All within the outer walls."""
        across, along = self.size[0] / 2.0 - OUTER_WALL, self.size[1] / 2.0 - OUTER_WALL
        return Rectangle(-across, -along, across, along)


def draw_plan(seed: int, number: int, storeys: tuple[int, int], *, small: bool = False) -> HousePlan:
    """Draw one house of a map.

    Args:
        seed: Of the map.
        number: Of the house, which keys its random numbers.
        storeys: Fewest and most.
        small: Whether it shall take little room.

    Returns:
        The plan.
    """
    dice = Dice(seed, Stream.HOUSES, agent=1000 + number)
    widest, deepest = (9.0, 8.0) if small else (14.0, 12.0)
    size = (dice.uniform(8.0, widest), dice.uniform(7.0, deepest))
    count = dice.integer(*storeys)
    plan = HousePlan(size, (), gable=dice.uniform() < 0.6)
    side = 1 if dice.uniform() < 0.5 else -1
    flights = [_draw_flight(dice, plan.room, side if level % 2 == 0 else -side) for level in range(count - 1)]
    partition = dice.uniform(-0.06, 0.06) * size[0]
    drawn = []
    for level in range(count):
        up = flights[level] if level < count - 1 else None
        hole = hole_over(flights[level - 1]) if level else None
        inner = _inner_walls(dice, plan.room, partition, up, hole)
        outer = _outer_walls(dice, plan, partition, inner, up, ground=level == 0)
        drawn.append(Storey(outer, inner, up, hole))
    return plan._replace(storeys=tuple(drawn))


def _draw_flight(dice: Dice, room: Rectangle, side: int) -> Flight:
    slack = room.front - room.back - FLIGHT_LENGTH - 2.0 * LANDING
    back = room.back + LANDING + slack * dice.uniform()
    left = room.right - STAIR_WIDTH if side > 0 else room.left
    outline = Rectangle(left, back, left + STAIR_WIDTH, back + FLIGHT_LENGTH)
    return Flight(outline, 1 if dice.uniform() < 0.5 else -1)


def hole_over(flight: Flight) -> Rectangle:
    """Return the hole in the floor above a flight."""
    left, back, right, front = flight.outline
    if flight.climb > 0:
        return Rectangle(left, back - HOLE_LEAD, right, front)
    return Rectangle(left, back, right, front + HOLE_LEAD)


def _inner_walls(
    dice: Dice, room: Rectangle, partition: float, up: Flight | None, hole: Rectangle | None
) -> tuple[Wall, ...]:
    """Part a storey in a left and a right half, and halves without stairs in a front and a back."""
    half = INNER_WALL / 2.0
    cuts = []
    for left, right in ((room.left, partition - half), (partition + half, room.right)):
        stairs = [area for area in (up.outline if up else None, hole) if area]
        if any(left < (area.left + area.right) / 2.0 < right for area in stairs):
            continue
        if right - left > 3.2 and room.front - room.back > 6.6 and dice.uniform() < 0.7:
            cut = dice.uniform(-0.12, 0.12) * (room.front - room.back)
            margin = DOOR_WIDTH / 2.0 + 0.5
            doorway = _doorway(dice.uniform(left + margin, right - margin))
            cuts.append(Wall(Rectangle(left, cut - half, right, cut + half), True, (doorway,)))
    place = _free_place(dice, room, [wall.outline for wall in cuts])
    main = Wall(
        Rectangle(partition - half, room.back, partition + half, room.front), False, (_doorway(place),)
    )
    return (main, *cuts)


def _doorway(middle: float) -> Opening:
    return Opening(middle, DOOR_WIDTH, 0.0, DOOR_HEIGHT)


def _free_place(dice: Dice, room: Rectangle, cuts: list[Rectangle]) -> float:
    """Return where along the main inner wall a doorway is clear of the walls that meet it."""
    margin = DOOR_WIDTH / 2.0 + 0.5
    for _ in range(50):
        place = dice.uniform(room.back + margin, room.front - margin)
        if all(abs(place - (cut.back + cut.front) / 2.0) > margin + 0.2 for cut in cuts):
            return place
    return room.back + margin


def _outer_walls(
    dice: Dice, plan: HousePlan, partition: float, inner: tuple[Wall, ...], up: Flight | None, *, ground: bool
) -> tuple[Wall, ...]:
    """Return the front, back, left and right wall with doorways (on the ground floor) and windows."""
    room = plan.room
    across, along = plan.size[0] / 2.0, plan.size[1] / 2.0
    fronts: list[Opening] = []
    backs: list[Opening] = []
    if ground:
        spans = _door_spans(room, partition, up)
        first = dice.integer(0, len(spans) - 1)
        fronts.append(_doorway(dice.uniform(*spans[first])))
        if plan.size[0] * plan.size[1] > LARGE_HOUSE:
            backs.append(_doorway(dice.uniform(*spans[len(spans) - 1 - first])))
    joints = [(partition, partition)]
    blocks = [wall.outline for wall in inner if wall.is_across] + ([_high_steps(up)] if up else [])
    lefts = [(block.back, block.front) for block in blocks if block.left == room.left]
    rights = [(block.back, block.front) for block in blocks if block.right == room.right]
    return (
        _wall(Rectangle(-across, room.front, across, along), True, fronts, joints),
        _wall(Rectangle(-across, -along, across, room.back), True, backs, joints),
        _wall(Rectangle(-across, room.back, room.left, room.front), False, [], lefts),
        _wall(Rectangle(room.right, room.back, across, room.front), False, [], rights),
    )


def _high_steps(flight: Flight) -> Rectangle:
    """Return the part of a flight that would stand before windows."""
    low = int(WINDOW_SILL / RISE) * GOING
    if flight.climb > 0:
        return flight.outline._replace(back=flight.outline.back + low)
    return flight.outline._replace(front=flight.outline.front - low)


def _door_spans(room: Rectangle, partition: float, up: Flight | None) -> list[tuple[float, float]]:
    """Return where a doorway may be in the front or back wall: clear of stairs and of the inner wall."""
    margin = DOOR_WIDTH / 2.0 + 0.15
    left, right = room.left, room.right
    if up and up.outline.left == room.left:
        left = up.outline.right
    elif up:
        right = up.outline.left
    halves = ((left, partition), (partition, right))
    return [(start + margin, end - margin) for start, end in halves if end - start > 2.0 * margin]


def _wall(
    outline: Rectangle, is_across: bool, doorways: list[Opening], blocked: list[tuple[float, float]]
) -> Wall:
    """Return an outer wall with windows wherever no doorway, inner wall or stairs are.

    Args:
        outline: Of the wall.
        is_across: Whether it runs across.
        doorways: In it.
        blocked: Start and end in m of what stands right behind it.

    Returns:
        The wall.
    """
    start, end = (outline.left, outline.right) if is_across else (outline.back, outline.front)
    start, end = start + OUTER_WALL, end - OUTER_WALL
    bays = max(1, int((end - start) / WINDOW_BAY))
    step = (end - start) / bays
    width = min(1.5, 0.5 * step)
    taken = [(door.middle - door.width / 2.0, door.middle + door.width / 2.0) for door in doorways] + blocked
    openings = list(doorways)
    for bay in range(bays):
        middle = start + (bay + 0.5) * step
        left, right = middle - width / 2.0 - PILLAR, middle + width / 2.0 + PILLAR
        if all(right < first or last < left for first, last in taken):
            openings.append(Opening(middle, width, WINDOW_SILL, WINDOW_TOP))
    return Wall(outline, is_across, tuple(sorted(openings)))
