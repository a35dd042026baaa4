"""One training environment, as an agent meets it: observations and actions, the same numbers."""

from collections.abc import Mapping
from typing import Any

from wildscav.agent import Action, MatchInfo, Observation
from wildscav.policy.action_modes import action_mode
from wildscav.policy.errors import PolicyError
from wildscav.policy.observation_groups import Events, Observer
from wildscav.policy.observation_stack import Stack, Stacked

FORMAT = 1


class Environment:
    """Makes the observations of an environment, and actions of what a policy chose.

    Args:
        description: What ``wildscav_engine.envs.describe`` said of the environment; with a table ``stack``
            if the policy saw several observations at once.

    Raises:
        PolicyError: The description is of another version, or incomplete.
    """

    def __init__(self, description: Mapping[str, Any]) -> None:
        if description.get("format") != FORMAT:
            raise PolicyError(
                f"the environment's description has format {description.get('format')!r}; this version reads "
                f"{FORMAT}: make the submission anew"
            )
        try:
            self.track, self.held = str(description["track"]), int(description["frames_per_action"])
            self.observer = Observer(description["observations"], flat=bool(description["flat"]))
            self.mode = action_mode(description["actions"])
            stack = description.get("stack")
            self._stack = stack and Stack(int(stack["count"]), stack["axis"], stack["padding"])
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise PolicyError(f"the environment's description is damaged: {error!r}") from error
        self._match: MatchInfo | None = None
        self._events = Events()

    def begin(self, match: MatchInfo) -> None:
        """Begin a match.

        Raises:
            PolicyError: The match is of another track, or its steps do not fit those of the environment.
        """
        if match.track != self.track:
            raise PolicyError(f"the policy was trained for the track {self.track}; this is {match.track}")
        if self.held % match.frames_per_action:
            raise PolicyError(
                f"the policy was trained with {self.held} frames per action, which is no multiple of the "
                f"{match.frames_per_action} of this match"
            )
        self._match, self._events = match, Events()
        if self._stack is not None:
            self._stack.clear()

    def skip(self, seen: Observation) -> None:
        """Take notice of a step in which the last choice is held."""
        self._events = self._events.with_step(seen)

    def observe(self, seen: Observation) -> Stacked:
        """Return the observation that the environment would have returned: arrays by name, or one row.

        Raises:
            PolicyError: No match has begun, or a sensor does not arrive as it was in training.
        """
        if self._match is None:
            raise PolicyError("no match has begun: call begin(match) in reset()")
        observation = self.observer.observe(self._match, seen, self._events.with_step(seen))
        self._events = Events()
        return observation if self._stack is None else self._stack.push(observation)

    def action(self, choice: Any, seen: Observation) -> Action:
        """Return the action that a choice of the environment's action space stands for.

        Raises:
            PolicyError: The choice is not of that space.
        """
        return self.mode.action(choice, seen.yaw)
