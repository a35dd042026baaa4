"""A trained policy that fights and an agent's skills that gather, for maps unlike those of the training.

A policy that was trained on small maps gathers little on large ones, whose houses are high and whose boxes
are far apart; and most of the time, it has nobody to fight there.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav.agent import Action, MatchInfo, Observation
from wildscav.policy.errors import PolicyError
from wildscav.skills.aiming import enemies_in_sight
from wildscav.skills.gathering import Gathering
from wildscav.skills.surroundings import Rings
from wildscav.skills.trained_gathering import GatheringPolicyAgent

LIDAR = "lidar"
SAME = 1e-6  # degrees between two rings that are one


class FightingPolicyAgent(GatheringPolicyAgent):
    """Plays the policy in a folder, but walks as ``Gathering`` says where there is nobody to fight.

    That is: in matches without a hot spot, while no enemy is in sight.

    The manifest asks for a LIDAR whose rings and columns contain those of the LIDAR that the policy sees.
    """

    rings: Rings  # the options of the LIDAR in the manifest; a class attribute of the submission's agent

    def reset(self, match: MatchInfo) -> None:
        """Begin a match. See ``Agent.reset``."""
        super().reset(match)
        self.match, self.gathering = match, Gathering(match, rings=self.rings)

    def act(self, observation: Observation) -> Action:
        """Return what the policy does, perhaps with other steps. See ``Agent.act``.

        Raises:
            PolicyError: The LIDAR does not have the rings and columns that the policy was trained with.
        """
        options = self.policy.environment.observer.options[LIDAR]
        lidar = thinned(observation.sensor(LIDAR), self.rings, options)
        action = super().act(replace(observation, tensors={**observation.tensors, LIDAR: lidar}))
        if self.knows_hot_spot(observation):
            return action
        self.gathering.look(observation)
        if not observation.alive or enemies_in_sight(observation, self.match.team):
            return action
        walk = self.gathering.walk(observation)
        return replace(
            action,
            walk_direction=walk.direction,
            walk_speed=walk.speed,
            jump=walk.jump,
            pick_up=observation.can_pick_up,
        )


def thinned(reading: NDArray[np.float32], rings: Rings, wanted: Mapping[str, Any]) -> NDArray[np.float32]:
    """Return those distances of a LIDAR that one with fewer rings and columns would read.

    Args:
        reading: (channels, azimuths) m.
        rings: The options of the LIDAR that read them.
        wanted: The options of the other one. It has the same range.

    Returns:
        Its (channels, azimuths) m.

    Raises:
        PolicyError: It looks where the first does not.
    """
    own = np.linspace(rings.highest, rings.lowest, reading.shape[0])
    others = np.linspace(wanted["highest"], wanted["lowest"], wanted["channels"])
    rows = np.abs(own[:, None] - others).argmin(axis=0)
    every = reading.shape[1] // wanted["azimuths"]
    if np.abs(own[rows] - others).max() > SAME or every * wanted["azimuths"] != reading.shape[1]:
        raise PolicyError(
            f"[sensors.lidar] of submission.toml has {reading.shape[0]} rings from {rings.lowest} to "
            f"{rings.highest} degrees and {reading.shape[1]} columns: among them must be the policy's "
            f"{wanted['channels']} rings from {wanted['lowest']} to {wanted['highest']} and "
            f"{wanted['azimuths']} columns"
        )
    return np.ascontiguousarray(reading[rows, ::every])
