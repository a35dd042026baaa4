"""A trained policy as an agent, which remembers the boxes that its policy could not reach."""

from pathlib import Path

from wildscav.skills.trained_gathering import GatheringPolicyAgent


class TrainedAgent(GatheringPolicyAgent):
    """Plays the policy that `policy.json` describes."""

    folder = Path(__file__).parent
