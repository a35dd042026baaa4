"""The agent that understands nothing."""

import random

from wildscav import Action, Agent, MatchInfo, Observation

NEW_DIRECTION = 0.05  # chance a step: every two seconds, about
MAX_TURN = 4.0  # degrees a frame


class Random(Agent):
    """Walks at random, and tries every button."""

    def reset(self, match: MatchInfo) -> None:
        """Take the seat's own random numbers, so that the same match is played the same way."""
        self.random = random.Random(match.seed)  # noqa: S311 (a game, not a secret)
        self.direction = self.random.uniform(0.0, 360.0)
        self.turn = 0.0

    def act(self, observation: Observation) -> Action:
        """Keep the direction most of the time; press each button now and then."""
        if self.random.random() < NEW_DIRECTION:
            self.direction = self.random.uniform(0.0, 360.0)
            self.turn = self.random.uniform(-MAX_TURN, MAX_TURN)
        return Action(
            walk_direction=self.direction,
            walk_speed=self.random.uniform(5.0, 10.0),
            turn=self.turn,
            look=-observation.pitch / 50.0,
            jump=self.random.random() < 0.05,
            pick_up=self.random.random() < 0.5,
            shoot=self.random.random() < 0.2,
            reload=observation.clip == 0,
        )
