"""What a seat of words remembers: boxes, agents, places, and what happened when."""

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from wildscav.agent import MatchInfo, Observation, SupplyBox, Vector, VisibleAgent
from wildscav.geometry import direction_to, distance, flat_distance, turn_to
from wildscav.skills.zone import safe_zone
from wildscav_language.phrases import quoted

EVENTS = 40  # the most that are remembered
FORGOTTEN_AGENT = 3.0  # s out of sight, after which an agent counts as newly seen
SURELY_SEEN = 12.0  # m, within which a box in the middle of the view would be listed
HALF_VIEW = 25.0  # degrees to each side, that are in the middle of the view
LISTED = 32  # boxes in an observation at most
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


class Event(NamedTuple):
    """Something that happened."""

    time: float  # s of game time
    text: str


class Seen(NamedTuple):
    """An agent as it was last seen."""

    time: float  # s of game time
    agent: VisibleAgent

    @property
    def position(self) -> Vector:
        """Where it was, m."""
        return self.agent.position

    @property
    def team(self) -> int:
        """Its team."""
        return self.agent.team


class Memory:
    """Takes in each observation of a match."""

    def __init__(self, match: MatchInfo, names: Sequence[str]) -> None:
        self.match, self.names = match, names
        self.boxes: dict[int, SupplyBox] = {}  # known and not taken, as far as the seat can know
        self.taken: set[int] = set()  # boxes that it picked up
        self.agents: dict[int, Seen] = {}  # by seat
        self.events: deque[Event] = deque(maxlen=EVENTS)
        self.houses: list[Vector] = []  # buildings, in the order in which they were noticed
        self.death: Vector | None = None  # where the body died last
        self.hit_from: Vector | None = None  # where the last hit came from, as far as it is known
        self.new_boxes: set[int] = set()  # first seen in the last observation
        self.new_agents: set[int] = set()  # not in sight before, in the last observation
        self.last: Observation | None = None

    def name_of(self, seat: int) -> str:
        """Return a seat's number and quoted name."""
        name = f" {quoted(self.names[seat])}" if seat < len(self.names) else ""
        return f"agent {seat}{name}"

    def update(self, observation: Observation) -> None:
        """Take in an observation."""
        self._note_events(observation)
        self._see_boxes(observation)
        self._see_agents(observation)
        self.last = observation

    def _note(self, observation: Observation, text: str) -> None:
        self.events.append(Event(observation.time, text))

    def _note_events(self, now: Observation) -> None:
        """Remember what happened in the last step."""
        last = self.last
        if last is None:
            return
        if now.hit_seat is not None:
            self._note(now, f"you hit {self.name_of(now.hit_seat)}")
        if now.hit_by_seat is not None:
            self._note(now, f"{self.name_of(now.hit_by_seat)} hit you")
            seen = self.agents.get(now.hit_by_seat)
            self.hit_from = None if seen is None else seen.position
        if now.gained:
            self._note(now, f"you picked up {now.gained} supplies")
        if last.alive and not now.alive:
            self.death = last.position
            self._note(now, "you died")
        if now.alive and not last.alive:
            self._note(now, "you came back to life")
        if now.target is not None and last.target is None:
            self._note(now, "your team found the target")
        begun = sum(last.time < wave.time <= now.time for wave in self.match.supply_waves)
        if begun:
            self._note(now, "supplies have appeared: see the waves")

    def _see_boxes(self, now: Observation) -> None:
        listed = {box.id: box for box in now.supply_boxes} if now.alive else {}
        self.new_boxes = listed.keys() - self.boxes.keys()
        for number, box in list(self.boxes.items()):
            if number not in listed and self._is_gone(now, box):
                del self.boxes[number]
        self.boxes.update(listed)

    def _is_gone(self, now: Observation, box: SupplyBox) -> bool:
        """Return whether a box that is not listed was taken; the seat's own pick-ups are noted."""
        far = distance(now.position, box.position)
        if now.gained and far < self.match.pick_up_distance + 2.0:
            self.taken.add(box.id)
            return True
        if not now.alive or len(now.supply_boxes) >= LISTED:
            return False
        if self.match.senses == "original":
            return far < self.match.supply_sight - 0.5
        off = turn_to(now.yaw, direction_to(now.position, box.position))
        return abs(off) < HALF_VIEW and 2.0 < far < SURELY_SEEN and abs(now.pitch) < 15.0

    def _see_agents(self, now: Observation) -> None:
        in_sight = now.agents if now.alive else ()
        self.new_agents = {
            agent.seat
            for agent in in_sight
            if agent.seat not in self.agents or now.time - self.agents[agent.seat].time > FORGOTTEN_AGENT
        }
        for seat in sorted(self.new_agents):
            self._note(now, f"{self.name_of(seat)} came into sight")
        self.agents.update({agent.seat: Seen(now.time, agent) for agent in in_sight})

    def nearest_box(self, here: Vector) -> int | None:
        """Return the number of the nearest known box."""
        return min(self.boxes, key=lambda number: distance(here, self.boxes[number].position), default=None)

    def danger(self) -> Vector | None:
        """Return where the enemy was that was seen last, or the last shot came from."""
        enemies = [seen for seen in self.agents.values() if seen.team != self.match.team]
        return max(enemies, key=lambda seen: seen.time).position if enemies else self.hit_from

    def note_house(self, place: Vector, apart: float) -> None:
        """Remember a building, which gets the next letter, unless a known one is nearer than some m."""
        is_known = any(flat_distance(place, house) < apart for house in self.houses)
        if not is_known and len(self.houses) < len(LETTERS):
            self.houses.append(place)

    def places(self) -> dict[str, Vector]:
        """Return the places that have names, m."""
        height = self.last.position[1] if self.last else 0.0
        found: dict[str, Vector] = {}
        target = self.match.target if self.last is None else self.last.target
        if target is not None:
            found["target"] = target
        found["start"] = self.match.start
        for number, wave in enumerate(self.match.supply_waves, start=1):
            found[f"wave {number}"] = (wave.center[0], height, wave.center[1])
        if self.last is not None and "zone" in self.last.tensors and self.last.tensors["zone"][0]:
            found["zone"] = safe_zone(self.last).next.center
        if self.death is not None:
            found["death"] = self.death
        found |= {f"place {letter}": place for letter, place in zip(LETTERS, self.houses, strict=False)}
        return found

    def place(self, name: str) -> Vector | None:
        """Return a place by its name, however it is written; ``A`` is place A."""
        wanted = name.strip().lower()
        known = {key.lower(): place for key, place in self.places().items()}
        return known.get(wanted) or known.get(f"place {wanted}")
