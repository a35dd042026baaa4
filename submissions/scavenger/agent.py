"""An agent that gathers: outdoors, and in buildings storey by storey."""

from wildscav import Action, Agent, MatchInfo, Observation
from wildscav.skills.gathering import Gathering


class Scavenger(Agent):
    """Fetches the supplies that bring most per second. It never fights."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.gathering = Gathering(match)

    def act(self, observation: Observation) -> Action:
        """Walk on, and pick up what is within reach."""
        self.gathering.look(observation)
        if not observation.alive:
            return Action()
        walk = self.gathering.walk(observation)
        return Action(
            walk_direction=walk.direction,
            walk_speed=walk.speed,
            jump=walk.jump,
            pick_up=observation.can_pick_up,
        )
