"""A training environment's observations and actions, with the same numbers, for an agent in a match."""

from collections.abc import Mapping
from typing import Any

from wildscav.agent import Action, MatchInfo, Observation
from wildscav.policy.action_modes import action_mode
from wildscav.policy.errors import PolicyError
from wildscav.policy.observation_groups import Events, Observer
from wildscav.policy.observation_stack import Stack, Stacked

FORMAT = 1


class Environment:
    """Makes an environment's observations, and turns choices of its action space into actions.

    Args:
        description: The result of ``wildscav_engine.envs.describe`` for the environment, with a table
            ``stack`` if the policy takes several observations at once.

    Raises:
        PolicyError: The description is of another version, or incomplete.
    """

    def __init__(self, description: Mapping[str, Any]) -> None:
        if description.get("format") != FORMAT:
            raise PolicyError(
                f"the environment's description has format {description.get('format')!r}; this version reads "
                f"{FORMAT}: export the policy again"
            )
        try:
            self.track = str(description["track"])
            self.frames_per_action = int(description["frames_per_action"])
            self.observer = Observer(description["observations"], flat=bool(description["flat"]))
            self.mode = action_mode(description["actions"])
            stack = description.get("stack")
            self._stack = stack and Stack(int(stack["count"]), stack["axis"], stack["padding"])
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise PolicyError(f"the environment's description is invalid: {error!r}") from error
        self._match: MatchInfo | None = None
        self._events = Events()

    def begin(self, match: MatchInfo) -> None:
        """Begin a match.

        Raises:
            PolicyError: The match is of another track, or an action of the environment is not a whole number
                of the match's steps.
        """
        if match.track != self.track:
            raise PolicyError(f"the policy was trained for the track {self.track}; this is {match.track}")
        if self.frames_per_action % match.frames_per_action:
            raise PolicyError(
                f"the policy was trained with {self.frames_per_action} frames per action, which is not a "
                f"multiple of the {match.frames_per_action} of this match"
            )
        self._match, self._events = match, Events()
        if self._stack is not None:
            self._stack.clear()

    def skip(self, seen: Observation) -> None:
        """Note the events of a step in which the last choice is held."""
        self._events = self._events.with_step(seen)

    def observe(self, seen: Observation) -> Stacked:
        """Return the observation that the environment would have returned: arrays by name, or one row.

        Raises:
            PolicyError: No match has begun, or a sensor's reading is not as in training.
        """
        if self._match is None:
            raise PolicyError("no match has begun: call begin(match) in reset()")
        observation = self.observer.observe(self._match, seen, self._events.with_step(seen))
        self._events = Events()
        return observation if self._stack is None else self._stack.push(observation)

    def action(self, choice: Any, seen: Observation) -> Action:
        """Return the action that a choice of the environment's action space stands for.

        Raises:
            PolicyError: The choice is not in that space.
        """
        return self.mode.action(choice, seen.yaw)
