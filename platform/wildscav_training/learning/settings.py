"""What a training run is: its environment, its hyperparameters, and presets of both."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from wildscav.errors import UserError
from wildscav.terminal.suggestions import did_you_mean
from wildscav_training.learning.opposition import Opposition
from wildscav_training.learning.start import Start

MODES = ("multidiscrete", "fine", "baseline")  # the action modes that can be learned
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
        """Return how many rollouts a number of steps needs."""
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

PRESETS = ("tuned", "paper")
# Who learns in a match: teams learn together, and elsewhere one learner meets the track's own opponents.
ALONE: dict[str, Any] = {"agents": 1, "opponents": None}
SEATS: dict[str, dict[str, Any]] = {"gathering": {"agents": 4}, "capture": {"agents": 4}}
TOGETHER = ("gathering",)  # where every learner would be a team of its own, if options did not say otherwise
# The sensors of the preset "tuned" on the way to a target: two rings of LIDAR show the walls on all sides,
# of which the depth map shows only those ahead.
ALL_ROUND = {"depth": {"width": 10, "height": 10}, "lidar": {"channels": 2, "azimuths": 32}}
# Rewards and sensors of the preset "tuned", where they are not the track's own.
SHAPED: dict[str, dict[str, Any]] = {
    "navigation": {"rewards": {"target_reached": 1.0, "approach": 0.01}, "sensors": ALL_ROUND},
    "capture": {"rewards": {"target_reached": 1.0, "approach": 0.01}, "sensors": ALL_ROUND},
}


@dataclass(frozen=True)
class TrainingSettings:
    """A training run."""

    track: str
    options: Mapping[str, Any]  # of the environment, those that differ from its defaults
    steps: int  # of all learners together
    seed: int
    hyperparameters: Hyperparameters
    curriculum: tuple[float, ...] = ()  # m, the start range of each stage but the last, which has none
    opposition: Opposition | None = None  # None: the opponents in the options
    start: Start | None = None  # None: the policy knows nothing

    def as_json(self) -> dict[str, Any]:
        """Return the settings as values for JSON."""
        own = {**asdict(self), "curriculum": list(self.curriculum), "options": dict(self.options)}
        for name in ("opposition", "start"):
            del own[name]
        numbers = asdict(self.hyperparameters) | {"layers": list(self.hyperparameters.layers)}
        numbers = {OLD_NAMES.get(name, name): value for name, value in numbers.items()}
        opposition = {} if self.opposition is None else {"opposition": self.opposition.as_json()}
        start = {} if self.start is None else {"start": self.start.as_json()}
        return {**own, "algorithm": "ppo", "hyperparameters": numbers, **opposition, **start}


def preset_settings(
    preset: str, track: str, options: Mapping[str, Any]
) -> tuple[Hyperparameters, dict[str, Any]]:
    """Return the hyperparameters of a preset, and its environment with the given options changed.

    Raises:
        UserError: There is no such preset, it has no environment of this track, or an option is invalid.
    """
    from wildscav_engine.envs import PRESETS as ENVIRONMENTS
    from wildscav_engine.envs.batched import multi_agent_config
    from wildscav_engine.envs.settings.presets import LADDERS

    if preset not in PRESETS:
        raise UserError(
            f"--preset is {preset!r}{did_you_mean(preset, PRESETS)}; the presets are {', '.join(PRESETS)}",
            exit_code=2,
        )
    # On a ladder, the level says who else plays.
    named = options.get("preset")
    is_ladder = isinstance(named, str) and named in LADDERS
    base: dict[str, Any] = {"flat": True, **({} if is_ladder else SEATS.get(track, ALONE))}
    if preset == "tuned":
        base |= {"version": 1, "action_mode": "multidiscrete", **SHAPED.get(track, {})}
    elif f"paper-{track}" in ENVIRONMENTS:
        base |= {"preset": f"paper-{track}", "version": 0}
    else:
        tracks = [name.removeprefix("paper-") for name in ENVIRONMENTS if name.startswith("paper-")]
        raise UserError(
            f"--preset paper is for the tracks of the paper's experiments, {', '.join(tracks)}, not {track}",
            exit_code=2,
        )
    made = {**base, **options}
    is_together = track in TOGETHER and not is_ladder and "teams" not in options
    try:
        config = multi_agent_config(track, made | ({"teams": None} if is_together else {}))
    except (TypeError, ValueError) as error:
        raise UserError(f"the options of the environment: {error}", exit_code=2) from None
    if is_together:
        own = [0] * (config.agents + len(config.teammates))
        made["teams"] = with_opponents(own, len(config.all_opponents))
    return TUNED if preset == "tuned" else PAPER, made


def with_opponents(teams: Sequence[int], opponents: int) -> list[int]:
    """Return the teams of seats, and of opponents behind them, each of whom is a team of its own."""
    first = max(teams) + 1
    return [*teams, *range(first, first + opponents)]


def changed(hyperparameters: Hyperparameters, changes: Mapping[str, Any]) -> Hyperparameters:
    """Return hyperparameters with some changed; a UserError if a name is unknown or a value is wrong."""
    known = asdict(hyperparameters)
    new_names = {old: new for new, old in OLD_NAMES.items()}
    changes = {new_names.get(name, name): value for name, value in changes.items()}
    for name, value in changes.items():
        if name not in known:
            raise UserError(
                f"--set: there is no {name!r}{did_you_mean(name, known)}; the hyperparameters are "
                f"{', '.join(known)}",
                exit_code=2,
            )
        _check(name, value, known[name])
    made: Any = {name: tuple(value) if name == "layers" else value for name, value in changes.items()}
    return replace(hyperparameters, **made)


def _check(name: str, value: object, default: object) -> None:
    """Check the value of a hyperparameter by the kind of its default."""
    if isinstance(default, bool):
        allowed, is_good = "true or false", isinstance(value, bool)
    elif isinstance(default, tuple):
        is_list = isinstance(value, list) and 1 <= len(value) <= 16
        allowed = "a list of 1 to 16 widths from 1 to 4096, such as [64,64]"
        is_good = is_list and all(type(width) is int and 1 <= width <= 4096 for width in value)  # type: ignore[attr-defined]
    elif isinstance(default, int):
        allowed, is_good = "an integer from 1 to 100,000", type(value) is int and 1 <= value <= 100_000
    else:
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        highest = 1.0 if name in {"gamma", "gae_lambda"} else 1e9
        allowed = f"a number from 0 to {highest:g}"
        is_good = is_number and 0.0 <= value <= highest  # type: ignore[operator]
    if not is_good:
        raise UserError(f"--set: {name} is {value!r}, must be {allowed}", exit_code=2)
