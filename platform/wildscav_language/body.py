"""The body of a seat of words: what it senses now, what it remembers, and how it walks, turns and fights."""

from collections.abc import Sequence

import numpy as np

from wildscav.agent import Action, MatchInfo, Observation, SupplyBox, Vector, VisibleAgent
from wildscav.geometry import direction_to, flat_distance, moved, turn_to
from wildscav.skills.aiming import Aim, Lookout, Thrift, aim_at, max_turn_of, velocity_of
from wildscav.skills.fighting import Dodging, steady, wants_reload
from wildscav.skills.gathering import LOOK_EVERY_OUTDOORS, RICH, Gathering
from wildscav.skills.scouting import Scouting
from wildscav.skills.supplies import WALL_HITS
from wildscav.skills.surroundings import CELL
from wildscav.skills.walking import FULL_SPEED, Walk, hold
from wildscav_language.calls import End, Reason, Steps, StopFor
from wildscav_language.memory import Memory

WALK_TURN = 9.0  # degrees per frame, to look where it walks
WITHOUT_SUPPLIES = ("navigation", "capture")  # tracks in which nobody picks anything up
UNARMED = (*WITHOUT_SUPPLIES, "gathering")  # tracks in which nobody shoots
HOUSE_DISTANCE = 30.0  # m, within which walls count as one building
STANDING = Walk(0.0, 0.0)
FIGHT_RANGE = 12.0  # m, beyond which an attack comes nearer
NEAR = 4.0  # m, within which walks stop at a goal
STOREY = 2.0  # m up or down, from which on a goal may be in a building
AHEAD = 8.0  # m, in which the straight way is checked for what is in it
A_PLACE = -2  # the number of a box that is none, but a place to walk to


class Body:
    """One seat of one match."""

    def __init__(self, match: MatchInfo, names: Sequence[str] = ()) -> None:
        """Begin before the first observation."""
        self.match = match
        self.gathers = match.track not in WITHOUT_SUPPLIES
        self.is_armed = match.track not in UNARMED
        self.gathering = Gathering(match)
        self.scouting = Scouting(match)
        self.dodging, self.lookout, self.thrift = Dodging(match), Lookout(match), Thrift()
        self.memory = Memory(match, names)
        self.enemies: list[VisibleAgent] = []  # in sight, nearest first
        self.holds_fire = False
        self.has_seen = False
        self.has_just_died = False
        self._goal: Vector | None = None  # that it walks to, if it is a place
        self.now: Observation
        self.told: Observation | None = None  # as the last text has it
        self.told_boxes: frozenset[int] = frozenset()  # that were known then

    def look(self, observation: Observation) -> None:
        """Take in an observation; call it in every step."""
        self.has_just_died = self.has_seen and self.now.alive and not observation.alive
        self.now, self.has_seen = observation, True
        self.memory.update(observation)
        self.gathering.look(observation)
        self.dodging.look(observation)
        self.thrift.look(observation)
        self.enemies = self.lookout.enemies(observation) if self.is_armed and observation.alive else []
        if observation.step % LOOK_EVERY_OUTDOORS == 0:
            self._note_houses()

    def _note_houses(self) -> None:
        """Remember the buildings whose walls the LIDAR has shown, one in a neighbourhood."""
        found, height = self.gathering.prospecting, self.now.position[1]
        for cell in zip(*np.nonzero(found.walls >= WALL_HITS), strict=True):
            place = (float(found.middle_x[cell]), height, float(found.middle_z[cell]))
            self.memory.note_house(place, HOUSE_DISTANCE)

    @property
    def turn_in_step(self) -> float:
        """The most that the view turns in a step, degrees."""
        return min(WALK_TURN, self.match.turn_speed / self.match.frames_per_second) * self.frames

    @property
    def frames(self) -> int:
        """Frames in a step."""
        return self.match.frames_per_action

    @property
    def waves_begun(self) -> int:
        """How many waves of supplies have appeared."""
        return sum(wave.time <= self.now.time for wave in self.match.supply_waves)

    def interruption(self, stop_for: Sequence[StopFor]) -> End | None:
        """Return the end of a tool that something cuts short, or None."""
        memory = self.memory
        if "hit" in stop_for and self.now.hit_by_seat is not None:
            return Reason.HIT, f"{memory.name_of(self.now.hit_by_seat)} hit you."
        fresh = [enemy.seat for enemy in self.enemies if enemy.seat in memory.new_agents]
        if "enemy" in stop_for and fresh:
            return Reason.ENEMY_SEEN, f"You see {memory.name_of(fresh[0])}."
        if "box" in stop_for and memory.new_boxes:
            return Reason.BOX_SEEN, f"You see box {min(memory.new_boxes)}."
        return None

    def pause(self, seconds: float, reason: Reason, sentence: str) -> Steps:
        """Stand for some seconds, a step at least, and end with a reason."""
        end = self.now.time + seconds
        while True:
            yield self.standing()
            if self.now.time >= end - 1e-9:
                return reason, sentence

    def waiting_for_life(self) -> Steps:
        """Wait until a dead body respawns; what a tool does for the dead."""
        while not self.now.alive:
            yield Action()
        return Reason.DONE, "You were dead, and have come back to life."

    def standing(self, turn: float = 0.0) -> Action:
        """Stand, and turn by some degrees at most, or aim at an enemy."""
        return self.moving(STANDING, self._turning(turn))

    def turning(self, degrees: float) -> Action:
        """Stand, and turn by some degrees at most, whoever is in sight."""
        return self.moving(STANDING, self._turning(degrees), fights=False)

    def standing_at(self, place: Vector) -> Action:
        """Stand, and face a place."""
        return self.standing(turn_to(self.now.yaw, direction_to(self.now.position, place)))

    def walking_to(self, goal: Vector) -> Action:
        """Walk to a place, past what is in the way, and on the ways through buildings near it."""
        here = self.now.position
        if flat_distance(here, goal) < NEAR and abs(goal[1] - here[1]) < 1.0 and not self.gathering.roofed:
            direct = hold(here, goal, self.match.step_time)
            steered, jump = self.gathering.steering.toward(self.now, goal)
            return self.moving(Walk(steered, direct.speed, jump))
        if self._goal is None or flat_distance(self._goal, goal) > 1.0:
            self.gathering.walker.stop()
        self._goal = goal
        is_hard = self.gathering.steering.detours > 1 or abs(goal[1] - here[1]) > STOREY
        return self.fetching(SupplyBox(A_PLACE, goal, RICH if is_hard else 0))

    def fetching(self, box: SupplyBox) -> Action:
        """Walk to a box, picking up whatever comes within reach; straight if nothing is known in the way."""
        gathering = self.gathering
        if not gathering.roofed and not gathering.walker.is_walking and self._is_straight(box.position):
            direction, jump = gathering.steering.toward(self.now, box.position)
            if gathering.steering.detours < 2:
                return self.moving(Walk(direction, FULL_SPEED, jump))
        return self.moving(gathering.fetch(self.now, box))

    def _is_straight(self, place: Vector) -> bool:
        """Return whether nothing that was seen is in the way to a place at about the same height."""
        here = self.now.position
        far = flat_distance(here, place)
        if abs(place[1] - here[1]) > max(STOREY, 0.5 * far):
            return False
        direction, rise = direction_to(here, place), (place[1] - here[1]) / max(far, CELL)
        for step in range(1, int(min(far, AHEAD) / CELL)):
            x, y, z = moved(here, direction, step * CELL)
            if not self.gathering.surroundings.is_free((x, y + rise * step * CELL, z)):
                return False
        return True

    def exploring(self) -> Action:
        """Walk to where nobody of the team has looked yet."""
        if self.match.track == "capture" and self.now.target is None:
            return self.walking_to(self.scouting.next_place(self.now))
        centre = self.gathering.centre(self.now.time)
        return self.walking_to(self.gathering.prospecting.next_place(self.now, centre))

    def fighting(self, seat: int) -> Action:
        """Fight an enemy that was seen: come within range, and dodge."""
        seen = self.memory.agents[seat]
        in_sight = next((enemy for enemy in self.enemies if enemy.seat == seat), None)
        if in_sight is None:
            return self.walking_to(seen.position)
        far = flat_distance(self.now.position, in_sight.position)
        closing = 35.0 if far > FIGHT_RANGE else 0.0
        walk = Walk(self.dodging.direction(self.now, in_sight.position, closing), FULL_SPEED)
        return self.moving(walk, enemy=in_sight)

    def moving(
        self, walk: Walk, aim: Aim | None = None, enemy: VisibleAgent | None = None, *, fights: bool = True
    ) -> Action:
        """Return the action of a walk: it looks ahead, or shoots at an enemy unless the seat holds fire."""
        enemy = enemy or next(iter(self.enemies), None)
        if enemy is not None and fights and not self.holds_fire:
            walk = steady(self.match, self.now, enemy, walk)
            own = velocity_of(walk.direction, walk.speed)
            aim = aim_at(self.now, enemy, own, self.frames, max_turn_of(self.match))
            aim = aim._replace(shoot=aim.shoot and self.thrift.may_shoot(self.now, enemy))
        elif aim is None:
            aim = self._turning(turn_to(self.now.yaw, walk.direction) if walk.speed else 0.0)
        return Action(
            walk_direction=walk.direction,
            walk_speed=walk.speed,
            jump=walk.jump,
            turn=aim.turn,
            look=aim.look,
            shoot=aim.shoot,
            reload=wants_reload(self.now, self.match.clip_size, bool(self.enemies)),
            pick_up=self.now.can_pick_up,
        )

    def _turning(self, degrees: float) -> Aim:
        """Turn by some degrees at most, and look level."""
        most = self.turn_in_step
        turn = max(-most, min(most, degrees)) / self.frames
        return Aim(turn, max(-WALK_TURN, min(WALK_TURN, -self.now.pitch / self.frames)))
