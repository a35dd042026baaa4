"""An agent that costs next to nothing."""

from wildscav import Action, Agent, Observation


class Walker(Agent):
    """Walks in a circle."""

    def act(self, observation: Observation) -> Action:
        """Return the next step along the circle."""
        return Action(walk_direction=observation.step * 3.0, walk_speed=6.0)
