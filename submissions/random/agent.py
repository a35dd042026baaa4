"""An agent that acts at random."""

import random

from wildscav import Action, Agent, MatchInfo, Observation

NEW_DIRECTION = 0.05  # probability per step: about every two seconds
MAX_TURN = 4.0  # degrees per frame


class Random(Agent):
    """Walks at random, and takes every kind of action at random."""

    def reset(self, match: MatchInfo) -> None:
        """Seed the random numbers with the seat's seed, so that the same match is played the same way."""
        self.random = random.Random(match.seed)  # noqa: S311 (a game, not a secret)
        self.direction = self.random.uniform(0.0, 360.0)
        self.turn = 0.0

    def act(self, observation: Observation) -> Action:
        """Keep the direction most of the time, and take other actions now and then."""
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
