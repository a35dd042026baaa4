"""An agent that walks straight to its goal."""

from wildscav import Action, Agent, MatchInfo, Observation, Vector
from wildscav.geometry import turn_to
from wildscav.skills.scouting import Scouting
from wildscav.skills.searching import Boxes, Search, effort
from wildscav.skills.steering import Steering
from wildscav.skills.zone import safe_zone

FULL_SPEED = 10.0  # m/s
MAX_TURN = 4.0  # degrees per frame


class Homing(Agent):
    """Walks to the target or to the nearest supply box, or searches for them, and stays in the safe zone."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.match = match
        self.steering = Steering(match.seed)
        self.search: Search | Scouting = Search(match) if match.supply_waves else Scouting(match)
        self.boxes = Boxes(effort)

    def act(self, observation: Observation) -> Action:
        """Walk at full speed, facing the direction of walking, and pick up boxes within reach."""
        goal = self.goal(observation)
        direction, jump = self.steering.toward(observation, goal)
        turn = turn_to(observation.yaw, direction) / self.match.frames_per_action
        return Action(
            walk_direction=direction,
            walk_speed=FULL_SPEED,
            turn=max(-MAX_TURN, min(MAX_TURN, turn)),
            look=-observation.pitch / self.match.frames_per_action,
            jump=jump,
            pick_up=observation.can_pick_up,
        )

    def goal(self, observation: Observation) -> Vector:
        """Return where to go: into the safe zone, to the target, a box, or the next place of the search."""
        zone = safe_zone(observation)
        if not zone.is_safe(observation.position):
            return zone.next.center
        if observation.target is not None:
            return observation.target
        place = self.boxes.choose(observation, zone.is_safe) or self.search.next_place(observation)
        return place if zone.is_safe(place) else zone.next.center
