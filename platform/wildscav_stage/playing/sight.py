"""What the person in a seat may know of a match, as short messages to their page.

A message is JSON. Lengths are whole centimetres, angles hundredths of a degree, times frames. It has
``frame``, ``own`` (see ``rows_of``) and, where there is anything to tell,

- ``others``: of each agent in sight its seat, x, y, z, yaw, and whether it is invincible, 0 or 1;
- ``shots`` since the last message: one's own and those of agents in sight, each the seat, x, y, z of the
  shooter's soles and, if it is one's own or that place is in sight, x, y, z of where it ended;
- ``hits`` and ``hurt``: the seats that one hit, and those that hit one; ``gained``: supplies;
- ``deaths``, which everybody is told: the seat, and the seat that did it or -1;
- ``killer``, with one's own death, if the killer was in sight in that frame: the seat, x, y, z, and its
  health where the rules tell it to agents (``senses = "original"``);
- ``boxes`` that the page was not told of before: serial, x, y, z; and ``gone``, the serials of those that are
  not there anymore, as far as the person can see;
- ``target``, once it is known: x, y, z; and ``zone``, the present phase of the safe zone as in
  ``Matches.zone``, when it is another one.

Agents and boxes are in sight as for an agent with the rule ``senses = "sighted"``, but boxes at any distance,
as for a camera. Where the rules tell of boxes behind walls, a person knows of them, too. A page that is
opened later is told of all boxes that the person knows of, but not of what happened before.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.world import World
from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.simulation.systems.visibility import BOX_TOP, Eye, sees_body, sees_point
from wildscav_engine.simulation.systems.zone import phase_at
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.rules import Senses
from wildscav_stage.scene.map_file import CENTIMETRES, centimetres

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match

HUNDREDTHS = 100  # of a degree
MESSAGE_FRAMES = 2  # from one message to the next
SHORT = 0.05  # m before the end of a shot: the end is on a surface, which may hide it
ON_GROUND, IN_WATER, CAN_PICK_UP, INVINCIBLE = 1, 2, 4, 8  # bits of an agent's flags
COUNTS = ("health", "clip", "spare_ammo", "supplies", "reload_left", "respawn_left", "invincible_left")


def rows_of(match: "Match") -> NDArray[np.int64]:
    """Return (A, 16) of each seat: x, y, z, yaw, pitch, velocity x, y, z, flags, and ``COUNTS``."""
    agents = match.state.agents
    flags = (
        ON_GROUND * agents.on_ground[0]
        + IN_WATER * agents.in_water[0]
        + CAN_PICK_UP * match.seen.can_pick_up[0]
        + INVINCIBLE * (agents.invincible_left[0] > 0)
    )
    angles = np.stack([agents.yaw[0], agents.pitch[0]], axis=1) * HUNDREDTHS
    counts = [getattr(agents, name)[0] for name in COUNTS]
    exact = (agents.position[0] * CENTIMETRES, angles, agents.velocity[0] * CENTIMETRES)
    return np.hstack([*(np.rint(part) for part in exact), np.stack([flags, *counts], axis=1)]).astype(int)


def boxes_of(match: "Match") -> NDArray[np.int64]:
    """Return (N,) the slots of the boxes that are present."""
    supplies = match.state.supplies
    return np.flatnonzero((supplies.quantity[0] > 0) & (supplies.appears[0] <= match.frame))


def box_rows(match: "Match", slots: NDArray[np.int64]) -> list[list[int]]:
    """Return the serial, x, y and z of boxes."""
    supplies = match.state.supplies
    places = centimetres(supplies.position[0][slots])
    rows: list[list[int]] = np.column_stack([supplies.serial[0][slots], places]).tolist()
    return rows


def zone_of(match: "Match") -> list[int] | None:
    """Return the present phase of the safe zone; None if there is none."""
    matches = match.state.matches
    phase = phase_at(matches, 0, match.frame)
    if phase < 0:
        return None
    row = matches.zone[0, phase]
    return [*row[:2].astype(int).tolist(), *centimetres(row[2:8]).tolist(), int(row[8])]


class Happenings:
    """The shots and deaths of a match, frame by frame from its start."""

    def __init__(self, match: "Match") -> None:
        self._match, self._counted = match, match.state.agents.deaths[0].copy()

    def shooters(self) -> list[int]:
        """Return the seats that fired in this frame."""
        return np.flatnonzero(self._match.state.agents.fired[0]).tolist()

    def deaths(self) -> list[list[int]]:
        """Return the seats that died since the last call, each with the seat that did it or NOBODY."""
        agents = self._match.state.agents
        died = np.flatnonzero(agents.deaths[0] > self._counted)
        self._counted[:] = agents.deaths[0]
        return [[seat, int(agents.hit_by_seat[0, seat])] for seat in died.tolist()]


class Known:
    """What a page was told of the present match."""

    def __init__(self) -> None:
        self.begin(None)

    def begin(self, sight: "Sight | None") -> None:
        """Forget everything, since another match is shown."""
        self.sight = sight
        self.due = 0  # the frame from which on it is told more
        self.boxes: set[int] = set()  # their serials
        self.target = False
        self.zone: list[int] | None = None


class Sight:
    """What one seat may know of a match, from its start."""

    def __init__(self, match: "Match", seat: int) -> None:
        self._match, self._seat = match, seat
        self._happenings, self._noted = Happenings(match), match.frame
        self._boxes: dict[int, NDArray[np.float32]] = {}  # places of known ones, by serials
        self.forget()

    def forget(self) -> None:
        """Forget what happened up to now and was not told."""
        self._shots: list[list[int]] = []
        self._deaths: list[list[int]] = []
        self._hits: list[int] = []
        self._hurt: list[int] = []
        self._killer: list[int] = []
        self._gained = 0

    def note(self) -> None:
        """Note what happened in a frame that was played."""
        agents, seat = self._match.state.agents, self._seat
        self._noted = self._match.frame
        died = self._happenings.deaths()
        self._deaths += died
        for by in (by for dead, by in died if dead == seat and by not in (NOBODY, seat)):
            self._killer = self._killer_of(by)
        self._shots += self._shots_seen(self._happenings.shooters())
        for noted, seats in ((self._hits, agents.hit_seat), (self._hurt, agents.hit_by_seat)):
            if seats[0, seat] != NOBODY:
                noted.append(int(seats[0, seat]))
        self._gained += int(agents.gained[0, seat])

    def _killer_of(self, seat: int) -> list[int]:
        """Return what is told of who shot this seat in this frame: nothing if it was not in sight."""
        agents, is_seen = self._match.state.agents, np.ones(1, np.bool_)
        soles = agents.position[0, [seat]]
        _keep_bodies_in_sight(self._match.game_map.world, self._own_eye(), soles, is_seen)
        if not is_seen[0]:
            return []
        tells_health = self._match.spec.rules.senses == Senses.ORIGINAL
        health = [int(agents.health[0, seat])] if tells_health else []
        return [seat, *centimetres(soles[0]).tolist(), *health]

    def _shots_seen(self, shooters: list[int]) -> list[list[int]]:
        if not shooters:
            return []
        seen = self._sees_agents()
        seen[self._seat] = True
        return [self._shot_of(shooter) for shooter in shooters if seen[shooter]]

    def _shot_of(self, shooter: int) -> list[int]:
        agents = self._match.state.agents
        soles, end = agents.position[0, shooter], agents.shot_end[0, shooter]
        way = end - soles - (0.0, EYE_HEIGHT, 0.0)
        before = end - way * min(1.0, SHORT / max(SHORT, float(np.linalg.norm(way))))
        is_told = shooter == self._seat or self._sees_all(before[None], 0.0)[0]
        return [shooter, *centimetres(soles).tolist(), *(centimetres(end).tolist() if is_told else ())]

    def has_news_for(self, known: Known) -> bool:
        """Return whether it is time for another message to a page, and the present frame was noted."""
        return self._noted == self._match.frame >= known.due

    def message(self, known: Known) -> dict[str, Any]:
        """Return what is new since the last message, and note in ``known`` what is told."""
        match, rows = self._match, rows_of(self._match)
        others = np.flatnonzero(self._sees_agents())
        shown = np.column_stack([others, rows[others, :4], rows[others, 8] & INVINCIBLE > 0]).tolist()
        self._look_at_boxes()
        told = {
            "others": shown,
            "shots": self._shots,
            "deaths": self._deaths,
            "hits": self._hits,
            "hurt": self._hurt,
            "killer": self._killer,
            "gained": self._gained,
            "boxes": self._new_boxes(known),
            "gone": sorted(known.boxes - self._boxes.keys()),
            "target": self._new_target(known),
            "zone": self._new_zone(known),
        }
        self.forget()
        known.boxes = set(self._boxes)
        known.due = match.frame + MESSAGE_FRAMES
        return {"frame": match.frame, "own": rows[self._seat].tolist()} | {
            name: value for name, value in told.items() if value
        }

    def _new_boxes(self, known: Known) -> list[list[int]]:
        new = ((serial, place) for serial, place in self._boxes.items() if serial not in known.boxes)
        return [[serial, *centimetres(place).tolist()] for serial, place in new]

    def _look_at_boxes(self) -> None:
        """Note new boxes, and forget those that are gone and would be in sight or reach if they were not."""
        supplies, slots = self._match.state.supplies, boxes_of(self._match)
        present = supplies.serial[0][slots].tolist()
        for serial in self._boxes.keys() - present:
            if self._misses(self._boxes[serial]):
                del self._boxes[serial]
        new = slots[[serial not in self._boxes for serial in present]]
        seen = self._sees_all(supplies.position[0][new], BOX_TOP)
        seen |= np.isin(new, self._match.seen.supplies[0, self._seat])
        found = new[seen]
        self._boxes.update(zip(supplies.serial[0][found].tolist(), supplies.position[0][found], strict=True))

    def _misses(self, place: NDArray[np.float32]) -> bool:
        reach = self._match.spec.rules.pick_up_distance
        near = np.linalg.norm(self._match.state.agents.position[0, self._seat] - place) <= reach
        return bool(near) or bool(self._sees_all(place[None], BOX_TOP)[0])

    def _new_target(self, known: Known) -> list[int] | None:
        matches, agents = self._match.state.matches, self._match.state.agents
        if known.target or not (matches.has_target[0] and agents.knows_target[0, self._seat]):
            return None
        known.target = True
        return [int(part) for part in centimetres(matches.target[0])]

    def _new_zone(self, known: Known) -> list[int] | None:
        zone = zone_of(self._match)
        if zone == known.zone:
            return None
        known.zone = zone
        return zone

    def _eye(self) -> Eye | None:
        """Return the eye of the seat; None if it is dead."""
        agents, seat = self._match.state.agents, self._seat
        return None if agents.health[0, seat] <= 0 else self._own_eye()

    def _own_eye(self) -> Eye:
        """Return the eye of the seat, also if it has just died."""
        agents, seat = self._match.state.agents, self._seat
        x, y, z = agents.position[0, seat].tolist()
        yaw, pitch = float(agents.yaw[0, seat]), float(agents.pitch[0, seat])
        return Eye(x, y + EYE_HEIGHT, z, yaw, pitch, self._match.spec.rules.view_angle)

    def _sees_agents(self) -> NDArray[np.bool_]:
        """Return (A,) which other agents are in sight."""
        agents, eye = self._match.state.agents, self._eye()
        seen: NDArray[np.bool_] = agents.present[0] & (agents.health[0] > 0)
        seen[self._seat] = False
        if eye is None:
            seen[:] = False
        else:
            _keep_bodies_in_sight(self._match.game_map.world, eye, agents.position[0], seen)
        return seen

    def _sees_all(self, places: NDArray[Any], above: float) -> NDArray[np.bool_]:
        """Return (N,) which points, some m above places, are in sight."""
        eye, seen = self._eye(), np.zeros(len(places), np.bool_)
        if eye is not None:
            points = np.array(places, np.float64)
            points[:, 1] += above
            _find_points_in_sight(self._match.game_map.world, eye, points, seen)
        return seen


@kernel
def _keep_bodies_in_sight(
    world: World, eye: Eye, soles: NDArray[np.float64], seen: NDArray[np.bool_]
) -> None:
    """Mark as not seen (A,) which of (A, 3) m bodies are not in sight."""
    for seat in range(soles.shape[0]):
        if seen[seat]:
            seen[seat] = sees_body(world, eye, soles[seat, 0], soles[seat, 1], soles[seat, 2])


@kernel
def _find_points_in_sight(
    world: World, eye: Eye, points: NDArray[np.float64], seen: NDArray[np.bool_]
) -> None:
    """Mark as seen (N,) which of (N, 3) m points are in sight."""
    for place in range(points.shape[0]):
        seen[place] = sees_point(world, eye, points[place, 0], points[place, 1], points[place, 2])
