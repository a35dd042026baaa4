"""Episodes that an agent plays in an environment, in this process."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from wildscav.errors import UserError
from wildscav_engine.envs.settings.config import read_config
from wildscav_engine.envs.settings.episodes import Episodes, Plan
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.actions import no_actions
from wildscav_training.datasets.episodes import Episode, Watcher, spaces_of
from wildscav_training.opponents import named_agent


class PlayedEpisodes:
    """Episodes of an agent in the seats of an environment's learners.

    The n-th match is the first that the environment plays after ``reset(seed=seed + n)``.

    Attributes:
        spaces: Of the observations and actions.
        config: The environment.
        count: The number of matches.
    """

    def __init__(
        self,
        agent: str,
        track: str,
        options: Mapping[str, Any],
        *,
        matches: int,
        seed: int = 0,
        together: bool = False,
    ) -> None:
        """Load the agent and check the options.

        Args:
            agent: The folder of a submission, the name of a baseline, "oracle" or "straight". Its code runs
                with all rights of this process.
            seed: Of the first match; the others count on.

        Raises:
            UserError: There is no such agent, it does not play the track, or an option is wrong.
        """
        self.count, self.seed, self._together = matches, seed, together
        self._controller = named_agent(agent)
        try:
            self._controller.check(track)
            self.config = read_config(track, options)
            self._plan = Plan(self.config)
        except (TypeError, ValueError) as error:
            raise UserError(f"the options of the environment: {error}", exit_code=2) from None
        self.spaces = spaces_of(self.config, together=together)

    def __iter__(self) -> Iterator[list[Episode]]:
        """Yield the episodes of each match in turn, or raise an AgentError if the agent's code failed."""
        for number in range(self.count):
            seed = self.seed + number
            about = {"agent": self._controller.name, "env_seed": seed}
            watcher = self._watched(seed)
            yield [watcher.together(about)] if self._together else watcher.alone(about)

    def _watched(self, seed: int) -> Watcher:
        """Play a match, and return who has watched it."""
        episode = Episodes(seed).next(self._plan)
        batch = Batch([episode.spec], [episode.game_map])
        seats = np.arange(self.config.agents)
        match = np.zeros(len(seats), np.int64)
        watcher = Watcher(self.config, batch, seats.tolist())
        self._controller.begin(batch, match, seats)
        actions = no_actions(len(episode.spec.seats))
        while not watcher.over:
            actions[seats] = self._controller.act(batch, match, seats)
            watcher.step(actions)
        return watcher
