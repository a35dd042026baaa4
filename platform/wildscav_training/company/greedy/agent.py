"""An agent that takes the boxes of another: those that lie nearest to it."""

from wildscav import Action, Agent, MatchInfo, Observation, SupplyBox, Vector
from wildscav.geometry import flat_distance, turn_to
from wildscav.skills.scouting import teammates
from wildscav.skills.searching import Boxes, Search, effort
from wildscav.skills.steering import Steering
from wildscav.skills.zone import safe_zone

FULL_SPEED = 10.0  # m/s
NEAR = 15.0  # m from the other, within which boxes are taken
ARM = 4.0  # m from the other, within which a box is taken before one gets there
LATE = 50.0  # m, added to the distance of such boxes


class Greedy(Agent):
    """Runs after a teammate, or else the nearest agent in sight, and takes what it would. It never fights."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.match = match
        self.steering, self.search = Steering(match.seed), Search(match)
        self.boxes = Boxes(self.cost)
        self.other: Vector | None = None  # where the one is whose boxes it takes

    def act(self, observation: Observation) -> Action:
        """Run at full speed, facing the direction of running, and pick up boxes within reach."""
        others = teammates(observation) or [agent.position for agent in observation.agents]
        self.other = others[0] if others else None
        direction, jump = self.steering.toward(observation, self.goal(observation))
        frames = self.match.frames_per_action
        return Action(
            walk_direction=direction,
            walk_speed=FULL_SPEED,
            turn=turn_to(observation.yaw, direction) / frames,
            look=-observation.pitch / frames,
            jump=jump,
            pick_up=observation.can_pick_up,
        )

    def goal(self, observation: Observation) -> Vector:
        """Return where to go: into the safe zone, to a box near the other, to the other, or on a search."""
        zone = safe_zone(observation)
        if not zone.is_safe(observation.position):
            return zone.next.center
        box = self.boxes.choose(observation, zone.is_safe)
        is_far = self.other is not None and flat_distance(observation.position, self.other) > NEAR
        return box or (self.other if is_far else None) or self.search.next_place(observation)

    def cost(self, here: Vector, box: SupplyBox) -> float:
        """Return how far a box is, which counts more where the other does not get it, or gets it first."""
        own = effort(here, box)
        theirs = own if self.other is None else flat_distance(self.other, box.position)
        return own + max(0.0, theirs - NEAR) + (LATE if theirs < min(own, ARM) else 0.0)
