"""A trained policy as an agent, made by `wildscav init --from-policy`."""

from pathlib import Path

from wildscav.policy import PolicyAgent


class TrainedAgent(PolicyAgent):
    """Plays the policy that `policy.json` describes.

    To change its behaviour, override `act`: `self.policy.act(observation)` is the policy's own action, and
    `self.policy.environment.observe(observation)` is what the training environment would have returned.
    """

    folder = Path(__file__).parent
