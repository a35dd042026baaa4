"""The hyperparameters of PPO, and those of the presets."""

from dataclasses import dataclass

# What some are called in the files of a run, and were called in 0.1.0.
OLD_NAMES = {"gamma": "discount", "gae_lambda": "trace", "kl_coeff": "divergence"}


@dataclass(frozen=True)
class Hyperparameters:
    """The settings of PPO. The defaults are those that learned the tasks here in the fewest steps."""

    matches: int = 64  # played at the same time
    rollout: int = 64  # steps of each match between two updates
    minibatch: int = 256  # steps of one learner
    epochs: int = 5  # passes over the steps of a rollout
    learning_rate: float = 7e-4
    anneal: bool = True  # let the learning rate fall to 0 over the run, in a straight line
    gamma: float = 0.99  # of the reward one step later
    gae_lambda: float = 0.95  # of generalized advantage estimation
    clip: float = 0.2  # how far the probability of an action may move in an update
    entropy: float = 0.003  # weight of the entropy
    value: float = 0.5  # weight of the squared error of the value
    kl_coeff: float = 0.0  # first weight of the KL divergence from the policy before; 0: without
    gradient_norm: float = 0.5  # longest gradient
    layers: tuple[int, ...] = (64, 64)  # width of each hidden layer, of the policy and of the value alike

    def rollouts(self, steps: int, learners: int) -> int:
        """Return how many rollouts a number of steps needs.

        Args:
            steps: Steps of all learners together.
            learners: Learners in a match.
        """
        return max(1, -(-steps // (self.matches * self.rollout * learners)))


TUNED = Hyperparameters()
# The paper's table of PPO, on RLlib; what it does not name is RLlib's default: 30 epochs, lambda 1, clip 0.3.
PAPER = Hyperparameters(
    matches=80,
    rollout=400,
    minibatch=256,
    epochs=30,
    learning_rate=1e-5,
    anneal=False,
    gae_lambda=1.0,
    clip=0.3,
    entropy=0.0,
    value=1.0,
    kl_coeff=0.2,
    gradient_norm=1e9,
    layers=(256, 256),
)
