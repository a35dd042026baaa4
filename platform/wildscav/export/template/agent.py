"""A trained policy as an agent, made by `wildscav init --from-policy`."""

from pathlib import Path

from wildscav.policy import PolicyAgent


class TrainedAgent(PolicyAgent):
    """Plays as `policy.json` says: its environment, its network, and how to choose by what that says.

    To change what it does, override `act`: `self.policy.act(observation)` is the policy's own action, and
    `self.policy.environment.observe(observation)` is what the training environment would have returned.
    """

    folder = Path(__file__).parent
