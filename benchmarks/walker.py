"""An agent that costs next to nothing."""

from wildscav import Action, Agent, Observation


class Walker(Agent):
    """Walks in a circle."""

    def act(self, observation: Observation) -> Action:
        """Return one more bit of the circle."""
        return Action(walk_direction=observation.step * 3.0, walk_speed=6.0)
