"""An agent to start from. It plays three of the five tracks: change `act` and see what happens."""

import random

from wildscav import Action, Agent, MatchInfo, Observation, Vector, VisibleAgent
from wildscav.geometry import BODY_HEIGHT, direction_to, flat_distance, pitch_to, turn_to

STUCK_SPEED = 1.0  # m/s: slower than this while walking means that something is in the way


class MyAgent(Agent):
    """Walks to the target or to the nearest supplies, and shoots at agents that it sees on the way."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match: this runs once, before the first step."""
        self.match = match
        self.random = random.Random(match.seed)  # the same choices in every run of the same match
        self.detour = 0  # steps left of a way around an obstacle
        self.detour_direction = 0.0
        self.goal = match.start  # where to look for supplies

    def act(self, observation: Observation) -> Action:
        """Return what to do in this step."""
        goal = self.choose_goal(observation)
        direction = self.walk_around(observation, direction_to(observation.position, goal))
        enemy = observation.agents[0] if observation.agents else None
        turn, look = self.aim(observation, direction, enemy)
        return Action(
            walk_direction=direction,
            walk_speed=10.0,
            turn=turn,
            look=look,
            jump=self.detour > 0,
            # Tracks without supplies or weapons ignore these.
            pick_up=observation.can_pick_up,
            shoot=enemy is not None and abs(turn) < 1.0 and abs(look) < 1.0,
            reload=observation.clip == 0,
        )

    def choose_goal(self, observation: Observation) -> Vector:
        """Return the target if there is one, else the nearest supplies, else a place that may have some."""
        if observation.target is not None:
            return observation.target
        if observation.supply_boxes:
            return observation.supply_boxes[0].position
        if flat_distance(observation.position, self.goal) < 3.0 or self.detour == 1:
            center, radius = (0.0, 0.0), self.match.map_size / 4
            if self.match.supply_waves:
                wave = self.random.choice(self.match.supply_waves)
                center, radius = wave.center, wave.radius
            edge = self.match.map_size / 2 - 2.0
            x, z = (self.random.gauss(middle, radius) for middle in center)
            self.goal = (max(-edge, min(edge, x)), 0.0, max(-edge, min(edge, z)))
        return self.goal

    def walk_around(self, observation: Observation, direction: float) -> float:
        """Return the direction to walk: sideways for a second if something is in the way."""
        speed = flat_distance((0.0, 0.0, 0.0), observation.velocity)
        if self.detour > 0:
            self.detour -= 1
            return self.detour_direction
        if observation.step > 0 and observation.alive and speed < STUCK_SPEED:
            self.detour = 10
            self.detour_direction = direction + self.random.choice((-110.0, -70.0, 70.0, 110.0))
        return direction

    def aim(
        self, observation: Observation, direction: float, enemy: VisibleAgent | None
    ) -> tuple[float, float]:
        """Return how far to turn and to look down in each frame, to face the enemy or the way ahead."""
        pitch = 0.0
        if enemy is not None:
            x, y, z = enemy.position
            direction = direction_to(observation.position, enemy.position)
            pitch = pitch_to(observation.position, (x, y + BODY_HEIGHT / 2, z))
        # An action is held for several frames, and its turn is applied in each of them.
        frames = self.match.frames_per_action
        return turn_to(observation.yaw, direction) / frames, (pitch - observation.pitch) / frames
