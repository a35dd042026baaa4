"""An agent that walks straight to its goal."""

from steering import Boxes, Search, Steering, Vector, effort

from wildscav import Action, Agent, MatchInfo, Observation
from wildscav.geometry import turn_to

FULL_SPEED = 10.0  # m/s
MAX_TURN = 4.0  # degrees per frame


class Homing(Agent):
    """Walks to the target, or to the nearest supply box in sight, or searches for one."""

    def reset(self, match: MatchInfo) -> None:
        """Remember the target and the waves of supplies."""
        self.match = match
        self.steering = Steering(match.seed)
        self.search = Search(match)
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
        """Return where to go now."""
        if observation.target is not None:
            return observation.target
        return self.boxes.choose(observation) or self.search.next_place(observation)
