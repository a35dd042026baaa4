"""The algorithms of ``wildscav train``: what each is, its hyperparameters, and what it cannot do."""

from dataclasses import dataclass, fields, replace

OURS, STABLE, RLLIB = "", "stable_baselines3", "ray.rllib"  # the library that an algorithm comes from


@dataclass(frozen=True)
class Hyperparameters:
    """The settings of PPO. The defaults are those that learned the tasks here in the fewest steps."""

    matches: int = 64  # played at the same time
    rollout: int = 64  # steps of each match between two updates
    minibatch: int = 256  # steps of one learner
    epochs: int = 5  # passes over the steps of a rollout
    learning_rate: float = 7e-4
    anneal: bool = True  # let the learning rate fall to 0 over the run, in a straight line
    discount: float = 0.99  # of the reward one step later
    trace: float = 0.95  # lambda of generalized advantage estimation
    clip: float = 0.2  # how far the probability of an action may move in an update
    entropy: float = 0.003  # weight of the entropy
    value: float = 0.5  # weight of the squared error of the value
    divergence: float = 0.0  # first weight of the KL divergence from the policy before; 0: without
    gradient_norm: float = 0.5  # longest gradient
    layers: tuple[int, ...] = (64, 64)  # width of each hidden layer, of the policy and of the value alike

    def rollouts(self, steps: int, learners: int) -> int:
        """Return how many rollouts a number of steps needs.

        Args:
            steps: Steps of all learners together.
            learners: Learners in a match.
        """
        return max(1, -(-steps // (self.matches * self.rollout * learners)))


# The paper's table of PPO, on RLlib; what it does not name is RLlib's default: 30 epochs, lambda 1, clip 0.3.
PAPER = Hyperparameters(
    matches=80,
    rollout=400,
    minibatch=256,
    epochs=30,
    learning_rate=1e-5,
    anneal=False,
    trace=1.0,
    clip=0.3,
    entropy=0.0,
    value=1.0,
    divergence=0.2,
    gradient_norm=1e9,
    layers=(256, 256),
)


@dataclass(frozen=True)
class Algorithm:
    """An algorithm and its settings."""

    title: str
    library: str
    unused: tuple[str, ...]  # the hyperparameters that it does not have
    tuned: Hyperparameters
    paper: Hyperparameters | None  # None: the paper did not try it

    @property
    def known(self) -> tuple[str, ...]:
        """The hyperparameters that it has."""
        return tuple(field.name for field in fields(Hyperparameters) if field.name not in self.unused)


TUNED = Hyperparameters()
# The paper's A3C has many workers that each play 400 steps; A2C waits for all of them before it learns.
PAPER_A3C = replace(PAPER, learning_rate=1e-4, entropy=0.01, value=0.5, divergence=0.0)
# The paper's table of IMPALA; what it does not name is RLlib's default. It has none of APPO, which gets the
# same.
PAPER_IMPALA = replace(
    PAPER, learning_rate=5e-4, entropy=0.01, value=0.5, divergence=0.0, gradient_norm=40.0, epochs=1
)
PAPER_APPO = replace(PAPER_IMPALA, clip=0.4, epochs=2)

ALGORITHMS: dict[str, Algorithm] = {
    "ppo": Algorithm("PPO in one file, to read and to start from", OURS, (), TUNED, PAPER),
    "sb3-ppo": Algorithm(
        "PPO of Stable-Baselines3", STABLE, ("divergence",), TUNED, replace(PAPER, divergence=0.0)
    ),
    "a2c": Algorithm(
        "A2C of Stable-Baselines3, the synchronous form of A3C",
        STABLE,
        ("minibatch", "epochs", "clip", "divergence"),
        replace(TUNED, rollout=5, learning_rate=2e-3),
        PAPER_A3C,
    ),
    "rllib-ppo": Algorithm("PPO of RLlib", RLLIB, (), TUNED, PAPER),
    "rllib-appo": Algorithm(
        "APPO of RLlib, PPO that does not wait for those that play",
        RLLIB,
        ("minibatch", "trace"),
        replace(TUNED, rollout=16, epochs=4),
        PAPER_APPO,
    ),
    "rllib-impala": Algorithm(
        "IMPALA of RLlib",
        RLLIB,
        ("minibatch", "epochs", "trace", "clip", "divergence"),
        # Its advantages are not scaled to a deviation of 1, so the entropy weighs more than it does in PPO.
        replace(TUNED, rollout=5, learning_rate=2e-3, entropy=3e-4),
        PAPER_IMPALA,
    ),
}
