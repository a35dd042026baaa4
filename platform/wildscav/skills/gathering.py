"""Gathering: what to fetch next and how to get there, outdoors and through the storeys of buildings.

A decision list, tried from the top whenever no way is being followed:

1. fetch the box that brings most per second, among those that a known way leads to;
2. look for a way to rich boxes nearby: go where nothing has been seen yet;
3. walk to the best box farther away, first out of the building by the ways that it came in;
4. look for boxes at buildings and in parts of the map not visited yet.
"""

from wildscav.agent import MatchInfo, Observation, SupplyBox, Vector
from wildscav.skills.paths import find_ways
from wildscav.skills.searching import effort
from wildscav.skills.steering import Steering
from wildscav.skills.supplies import BoxMemory, Prospecting
from wildscav.skills.surroundings import Rings, Surroundings
from wildscav.skills.walking import FULL_SPEED, Walk, WayWalker
from wildscav.skills.zone import USUAL, Caution, safe_zone

RINGS = Rings(range=60.0, lowest=-55.0, highest=45.0)  # as in the manifests of the agents that gather
REACH = 20.0  # m to each side in which ways are searched
ENOUGH = 12.0  # m beyond the nearest box, within which others are compared
START_UP = 0.4  # s added to the time for each box
PACE = 8.0  # m/s along ways
PACE_OUTDOORS = 6.0  # m/s of straight lines, which have obstacles
LEAST_RATE = 0.4  # supplies per second; for less, it is better to look for more
RICH = 8  # supplies: such boxes are in buildings
TRIES = 14  # ways to unseen places for one box
LEFT_ALONE = 150.0  # s for which a box that cannot be reached is ignored
CLOSE = 0.5  # m, unseen places nearer than this are not worth a way
SHORT = 2.0  # m, shorter ways towards places far away lead nowhere
LOOK_EVERY = 2  # steps between the readings of the LIDAR near buildings
LOOK_EVERY_OUTDOORS = 10


class Gathering:
    """Fetches supplies for one agent in one match."""

    def __init__(self, match: MatchInfo, caution: Caution = USUAL, rings: Rings = RINGS) -> None:
        """Begin with nothing known; the LIDAR has the rings of the submission's manifest."""
        self.match = match
        self.caution = caution
        self.rings = rings
        self.memory = BoxMemory(match)
        self.surroundings = Surroundings(match.map_size, rings)
        self.prospecting = Prospecting(match)
        self.walker = WayWalker(self.surroundings, match.step_time)
        self.steering = Steering(match.seed)
        self.wanted: int | None = None  # the box that it is on the way to
        self.tries: dict[int, int] = {}  # ways to unseen places, by box
        self.roofed = False  # whether there is something overhead
        self.fleeing = False  # into the safe zone
        self.give_up_at = 0.0  # s, when the box that is walked straight to counts as out of reach
        self.rest = 0.0  # s until which no ways are searched, because none was found

    def look(self, observation: Observation) -> None:
        """Take in an observation. Call it in every step, also when the agent does something else."""
        self.memory.update(observation)
        if not observation.alive:
            self.wanted = None
            self.walker.stop()
            return
        here = observation.position
        self.surroundings.stand(here)
        near = self.roofed or any(box.quantity >= RICH for box in observation.supply_boxes)
        if observation.step % (LOOK_EVERY if near else LOOK_EVERY_OUTDOORS) == 0:
            reading = observation.sensor("lidar")
            self.surroundings.see(here, observation.yaw, reading)
            self.roofed = self.surroundings.is_roofed(here)
            if not self.roofed:
                self.prospecting.note_walls(here, observation.yaw, reading, self.rings)
            self.prospecting.visit(here)

    def walk(self, observation: Observation) -> Walk:
        """Return how to walk in this step, in a royale within the safe zone. Call ``look`` first."""
        zone = safe_zone(observation, self.caution)
        self._drop_what_is_over(zone.is_safe(observation.position))
        walk = self.walker.walk(observation) if self.walker.is_walking else None
        if walk is not None:
            return walk
        if self.fleeing:
            return self.go(observation, zone.next.center)
        wanted = self.memory.wanted(observation.time)
        boxes = {key: box for key, box in wanted.items() if zone.is_safe(box.position)}
        walk = self.walker.walk(observation) if self._finds_way(observation, boxes) else None
        if walk is not None:
            return walk
        goal = self._far_goal(observation, boxes)
        return self.go(observation, goal if zone.is_safe(goal) else zone.next.center)

    def fetch(self, observation: Observation, box: SupplyBox) -> Walk:
        """Return how to walk to one box, which is the caller's choice. Call ``look`` first."""
        if self.wanted != box.id:
            self.walker.stop()
        walk = self.walker.walk(observation) if self.walker.is_walking else None
        if walk is None and self._finds_way(observation, {box.id: box}):
            walk = self.walker.walk(observation)
        self.wanted = box.id
        return walk or self.go(observation, box.position)

    def _drop_what_is_over(self, is_safe: bool) -> None:
        """Follow no way to a box that is gone, nor one to supplies while the safe zone shrinks."""
        is_gone = self.wanted is not None and self.wanted not in self.memory.boxes
        if is_gone or (not is_safe and not self.fleeing):
            self.wanted = None
            self.walker.stop()
        self.fleeing = not is_safe

    def _finds_way(self, observation: Observation, boxes: dict[int, SupplyBox]) -> bool:
        """Return whether there is a way to follow: to a box, to an unseen place, or out."""
        here = observation.position
        near = {key: box.position for key, box in boxes.items() if _is_within(here, box.position, REACH)}
        is_built = self.roofed or any(boxes[key].quantity >= RICH for key in near)
        if not near or not is_built or not observation.on_ground:
            return False
        rich = [boxes[key] for key in near if boxes[key].quantity >= RICH]
        hints = [box.position for box in rich]
        ways = find_ways(self.surroundings, here, near, REACH, enough=ENOUGH, hints=hints)
        if ways.to:
            self.wanted = max(ways.to, key=lambda key: _rate(boxes[key], ways.to[key].length / PACE))
            self.walker.take(ways.to[self.wanted])
            return True
        if ways.unseen is not None and ways.unseen.length > CLOSE:
            end = ways.unseen.points[-1]
            self._count_try(min(rich, key=lambda box: effort(end, box)), observation.time)
            self.walker.take(ways.unseen)
            return True
        for box in rich:
            self.memory.leave_alone(box.id, observation.time + LEFT_ALONE)
        return False

    def _count_try(self, box: SupplyBox, time: float) -> None:
        self.tries[box.id] = self.tries.get(box.id, 0) + 1
        if self.tries[box.id] >= TRIES:
            self.tries[box.id] = 0
            self.memory.leave_alone(box.id, time + LEFT_ALONE)

    def _far_goal(self, observation: Observation, boxes: dict[int, SupplyBox]) -> Vector:
        """Return the best box farther away, or where boxes may be."""
        here, now = observation.position, observation.time
        if self.wanted is not None and now > self.give_up_at:
            self.memory.leave_alone(self.wanted, now + LEFT_ALONE / 5.0)
            boxes.pop(self.wanted, None)
            self.wanted = None
        if self.wanted not in boxes and boxes:
            far = {key: effort(here, box) for key, box in boxes.items()}
            best = max(boxes, key=lambda key: _rate(boxes[key], far[key] / PACE_OUTDOORS))
            if _rate(boxes[best], far[best] / PACE_OUTDOORS) > LEAST_RATE:
                self.wanted, self.give_up_at = best, now + 4.0 + far[best] / 5.0
        if self.wanted is not None and self.wanted in boxes:
            return boxes[self.wanted].position
        self.wanted = None
        return self.prospecting.next_place(observation, self.centre(now))

    def go(self, observation: Observation, goal: Vector) -> Walk:
        """Return how to walk far: straight, but out of buildings and past obstacles on known ways."""
        walk = self.walker.walk(observation) if self.walker.is_walking else None
        if walk is not None:
            return walk
        direction, jump = self.steering.toward(observation, goal)
        hindered = self.roofed or self.steering.detours > 1
        if hindered and observation.time >= self.rest and observation.on_ground:
            way = find_ways(self.surroundings, observation.position, {}, REACH, far=goal).toward
            if way is not None and way.length > SHORT:
                self.walker.take(way)
                walk = self.walker.walk(observation)
                if walk is not None:
                    return walk
            self.rest = observation.time + 2.0
        return Walk(direction, FULL_SPEED, jump)

    def centre(self, time: float) -> tuple[float, float]:
        """Return the centre of the last wave of supplies, x and z."""
        waves = [wave for wave in self.match.supply_waves if wave.time <= time]
        return waves[-1].center if waves else (0.0, 0.0)


def _is_within(here: Vector, place: Vector, reach: float) -> bool:
    return max(abs(place[0] - here[0]), abs(place[2] - here[2])) < reach - 2.0


def _rate(box: SupplyBox, seconds: float) -> float:
    return box.quantity / (seconds + START_UP)
