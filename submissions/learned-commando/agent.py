"""A trained policy that fights; in matches without a hot spot, its agent gathers by a map that it makes."""

from pathlib import Path

from wildscav.skills.surroundings import Rings
from wildscav.skills.trained_fighting import FightingPolicyAgent


class TrainedAgent(FightingPolicyAgent):
    """Plays the policy that `policy.json` describes."""

    folder = Path(__file__).parent
    rings = Rings(range=100.0, lowest=-55.0, highest=45.0)  # as in submission.toml
