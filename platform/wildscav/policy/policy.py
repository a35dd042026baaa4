"""A trained policy as an agent."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from wildscav.agent import Action, Agent, MatchInfo, Observation
from wildscav.policy.action_choice import chooser_of
from wildscav.policy.environment import Environment
from wildscav.policy.errors import PolicyError
from wildscav.policy.networks import Choose, load_network

FILE = "policy.json"


class Policy:
    """A training environment, a network, and a rule for choosing by its outputs.

    Attributes:
        environment: Makes the observations and actions of the training environment.
        network: Turns an observation into outputs.
        chooser: Turns outputs into a choice of the action space.
    """

    def __init__(self, folder: Path) -> None:
        """Load a policy from a submission's folder, which contains ``policy.json``.

        Raises:
            PolicyError: The file, or the network that it names, cannot be used.
        """
        description = _read(folder / FILE)
        self.environment = Environment(_table(folder / FILE, description, "environment"))
        network = _table(folder / FILE, description, "network")
        self.network = load_network(folder, network)
        self.chooser = chooser_of(self.environment.mode, network, description.get("choose", Choose.SAMPLED))
        self._random = np.random.default_rng(0)
        self._action, self._until = Action(), 0  # the action that is held, and until which frame

    def begin(self, match: MatchInfo) -> None:
        """Begin a match. Its seed makes the random numbers the same in every run.

        Raises:
            PolicyError: The match is of another track, or an action of the environment is not a whole number
                of the match's steps.
        """
        self.environment.begin(match)
        self._random = np.random.default_rng(match.seed)
        self._action, self._until = Action(), 0

    def act(self, seen: Observation) -> Action:
        """Return what the policy does in this step.

        If the environment holds actions longer than the match, an action is held for several steps.

        Raises:
            PolicyError: The network's outputs do not give a choice of the action space.
        """
        if seen.frame < self._until:
            self.environment.skip(seen)
            return self._action
        outputs = self.network(self.environment.observe(seen))
        self._action = self.environment.action(self.chooser(outputs, self._random), seen)
        self._until = seen.frame + self.environment.frames_per_action
        return self._action


class PolicyAgent(Agent):
    """Plays the policy in a folder: the base class of agents that ``wildscav init --from-policy`` makes."""

    folder: Path  # of policy.json; a class attribute of the submission's agent

    def __init__(self) -> None:
        self.policy = Policy(self.folder)

    def reset(self, match: MatchInfo) -> None:
        """Begin a match. See ``Agent.reset``."""
        self.policy.begin(match)

    def act(self, observation: Observation) -> Action:
        """Return what the policy does. See ``Agent.act``."""
        return self.policy.act(observation)


def _table(path: Path, description: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    if not isinstance(description.get(name), dict):
        raise PolicyError(f"{path} has no {name!r}, which must be a JSON object")
    table: Mapping[str, Any] = description[name]
    return table


def _read(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text("utf-8"))
    except OSError as error:
        raise PolicyError(f"cannot read {path}: {error.strerror}") from None
    except ValueError as error:
        raise PolicyError(f"{path} is not valid JSON: {error}") from None
    if not isinstance(content, dict):
        raise PolicyError(f"{path} must hold a JSON object")
    return content
