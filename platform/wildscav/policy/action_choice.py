"""From a network's outputs to a choice: an element of the environment's action space."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav.policy.action_modes import ActionMode
from wildscav.policy.errors import PolicyError
from wildscav.policy.networks import Choose

# The meaning of a network's outputs.
SCORES = "scores"  # logits of the choices in each dimension, dimension after dimension
VALUES = "values"  # values of the choices, such as Q values; the best one is chosen
NUMBERS = "numbers"  # the mean of each number; standard deviations are in policy.json
SQUASHED = "squashed"  # mean and log standard deviation of each number, before a tanh (SAC)
ACTIONS = "actions"  # the choice itself
HEADS = (SCORES, VALUES, NUMBERS, SQUASHED, ACTIONS)
LOWEST_LOG_STD, HIGHEST_LOG_STD = -20.0, 2.0  # the bounds in SAC


class Chooser:
    """Chooses by a network's outputs.

    Args:
        head: The meaning of the outputs, one of ``HEADS``.
        deviations: (numbers,) standard deviations for the head "numbers".

    Raises:
        PolicyError: The head does not fit the action mode.
    """

    def __init__(
        self, mode: ActionMode, head: str, choose: Choose, deviations: NDArray[np.float64] | None = None
    ) -> None:
        self._mode, self._head, self._choose = mode, head, choose
        self._deviations = np.zeros(mode.numbers) if deviations is None else deviations
        if head not in HEADS:
            raise PolicyError(f"policy.json has the head {head!r}; the heads are {', '.join(HEADS)}")
        wanted = mode.sizes if head in {SCORES, VALUES} else (mode.numbers,) if head != ACTIONS else (1,)
        if not any(wanted) or (head == VALUES and len(mode.sizes) != 1):
            raise PolicyError(f"the head {head!r} does not fit the action mode, {type(mode).__name__}")
        if head == NUMBERS and self._deviations.shape != (mode.numbers,):
            raise PolicyError(f"there are {self._deviations.size} deviations, must be {mode.numbers}")

    @property
    def outputs(self) -> int:
        """How many outputs a network must have."""
        if self._head in {SCORES, VALUES}:
            return sum(self._mode.sizes)
        if self._head == ACTIONS:
            return self._mode.numbers or len(self._mode.sizes)
        return self._mode.numbers * (2 if self._head == SQUASHED else 1)

    def __call__(self, outputs: NDArray[Any], random: np.random.Generator) -> NDArray[Any]:
        """Return a choice of the action space.

        Args:
            outputs: (n,) the network's outputs.

        Raises:
            PolicyError: There are too many or too few outputs, or some are not finite.
        """
        if outputs.shape != (self.outputs,) or not np.isfinite(outputs).all():
            raise PolicyError(f"the network returned {outputs!r}, must be {self.outputs} finite numbers")
        if self._head == ACTIONS:
            return np.clip(outputs, -1.0, 1.0) if self._mode.numbers else outputs.astype(np.int64)
        if self._head in {SCORES, VALUES}:
            return self._choices(outputs, random)
        return self._numbers(outputs, random)

    def _choices(self, scores: NDArray[Any], random: np.random.Generator) -> NDArray[np.int64]:
        if self._choose == Choose.SAMPLED and self._head == SCORES:
            scores = scores + random.gumbel(size=scores.shape)  # the maximum is a sample from the softmax
        dimensions = np.split(scores, np.cumsum(self._mode.sizes)[:-1])
        return np.array([dimension.argmax() for dimension in dimensions], np.int64)

    def _numbers(self, outputs: NDArray[Any], random: np.random.Generator) -> NDArray[np.float32]:
        count, deviations = self._mode.numbers, self._deviations
        means = outputs[:count].astype(np.float32)
        if self._head == SQUASHED:
            deviations = np.exp(np.clip(outputs[count:], LOWEST_LOG_STD, HIGHEST_LOG_STD))
        if self._choose == Choose.SAMPLED:
            means = (means + deviations * random.standard_normal(count)).astype(np.float32)
        return np.tanh(means) if self._head == SQUASHED else np.clip(means, -1.0, 1.0)


def chooser_of(mode: ActionMode, network: Mapping[str, Any], choose: object) -> Chooser:
    """Return the chooser that a ``policy.json`` describes: its table "network", and "choose", unchecked.

    Raises:
        PolicyError: ``choose`` is not a ``Choose``, or the network does not fit the action mode.
    """
    if not isinstance(choose, str) or choose not in list(Choose):
        raise PolicyError(f"policy.json: choose is {choose!r}, must be {' or '.join(Choose)}")
    deviations = network.get("deviations")
    try:
        given = None if deviations is None else np.array(deviations, np.float64)
    except (TypeError, ValueError):
        raise PolicyError(f"policy.json: deviations is {deviations!r}, must be a list of numbers") from None
    return Chooser(mode, str(network.get("head")), Choose(choose), given)
