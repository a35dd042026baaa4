"""A session with a client: episode after episode, until it closes."""

import logging
import os
import time
from pathlib import Path
from typing import TYPE_CHECKING

from wildscav.errors import describe
from wildscav.legacy.actions import read_actions
from wildscav.legacy.channel import Client
from wildscav.legacy.commander_pb2 import GameState, GMCommand, Reply
from wildscav.legacy.episode import Episode, RefusedEpisodeError, read_episode
from wildscav.legacy.request_messages import START, Requests
from wildscav.legacy.start_places import settle_places
from wildscav.terminal.console import counted

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wildscav_engine.simulation.match import Match

LONGEST_SUFFIX = 100  # characters

log = logging.getLogger("wildscav.legacy")


class Session:
    """What the engine does for one client, from its first call to its end.

    Args:
        client: Which one.
        records: Folder of the records that it asks for.
    """

    def __init__(self, client: Client, records: Path) -> None:
        self._client, self._records = client, records
        self._episodes = 0
        self._unknown_ids: set[int] = set()  # ids of no agent, warned of in this episode

    def run(self) -> None:
        """Play what the client asks for until it closes.

        Raises:
            ClientGoneError: It is there no longer.
            RefusedEpisodeError: It asks for what cannot be.
            TooLargeError: It asks for more than it can be told.
        """
        reply = self._client.ask(START)
        while reply.game_state != GameState.CLOSE:
            if reply.game_state == GameState.RESET:
                reply = self._play(reply.gm_cmd)
            else:
                # There is no episode, so there is nothing to do but to ask again.
                log.warning("the client replies %d, but no episode is being played", reply.game_state)
                reply = self._client.ask(START)
        log.info("closed by the client after %s", counted(self._episodes, "episode"))

    def _play(self, command: GMCommand) -> Reply:
        """Play an episode, and return the reply that ends it."""
        self._episodes += 1
        self._unknown_ids.clear()
        episode = read_episode(command)
        match = self._match_of(episode)
        what = f"map {episode.map_id:03}, {match.track.name}, {counted(match.seats, 'agent')}"
        log.info("episode %d: %s, at most %g s", self._episodes, what, match.spec.time_limit)
        requests, began = Requests(match, episode), time.perf_counter()
        told, is_over = requests.next(), False
        reply = self._client.ask(told)
        while reply.game_state == GameState.UPDATE:
            # Who goes on after the end is told the end again.
            if not is_over:
                match.step(self._actions(reply, episode))
                told, is_over = requests.next(), match.over
                if is_over:
                    self._end(episode, match, time.perf_counter() - began)
            reply = self._client.ask(told)
        if not is_over:
            self._end(episode, match, time.perf_counter() - began)
        return reply

    def _match_of(self, episode: Episode) -> "Match":
        """Return the match of an episode, and everything ready for it: that may take long."""
        from wildscav.server.hosting.precompile import precompile

        with self._client.watched():
            precompile(())
            return match_of(episode)

    def _actions(self, reply: Reply, episode: Episode) -> "NDArray[np.float32]":
        """Return what the agents do; that there is no agent of an id is said once an episode."""
        rows, unknown = read_actions(reply.agent_cmd_list, episode.seats)
        for unknown_id in set(unknown) - self._unknown_ids:
            self._unknown_ids.add(unknown_id)
            log.warning("there is no agent %d; its actions are left out", unknown_id)
        return rows

    def _end(self, episode: Episode, match: "Match", seconds: float) -> None:
        """Say how an episode ended, and record it, before the client hears of it: then it may go at once."""
        how = match.result().ending.replace("_", " ") if match.over else "interrupted"
        rate = match.step_number / seconds
        log.info("episode %d: %s after %d frames; %.0f actions/s", self._episodes, how, match.frame, rate)
        if episode.is_recorded:
            self._record(episode, match)

    def _record(self, episode: Episode, match: "Match") -> None:
        """Write the record of an episode that was played to its end."""
        from wildscav_engine.record import SUFFIX, write_record

        if not match.over:
            log.warning("no record of episode %d: it was interrupted", self._episodes)
            return
        moment = time.strftime("%Y%m%d-%H%M%S")
        suffix = "".join(letter if letter.isalnum() or letter in "-_." else "_" for letter in episode.suffix)
        name = f"{moment}-{os.getpid()}-{self._episodes:03}{suffix[:LONGEST_SUFFIX]}{SUFFIX}"
        try:
            self._records.mkdir(parents=True, exist_ok=True)
            write_record(self._records / name, match, episode.names)
        except OSError as error:
            log.error("no record of episode %d: %s", self._episodes, describe(error))
        else:
            log.info("record of episode %d: %s", self._episodes, self._records / name)


def match_of(episode: Episode) -> "Match":
    """Return the match of an episode.

    Raises:
        RefusedEpisodeError: It cannot be set up.
    """
    from wildscav_engine.maps import MapError, load_map
    from wildscav_engine.simulation.match import Match, MatchSetupError

    try:
        game_map = load_map(episode.map_id)
        spec, moved = settle_places(episode, game_map)
        for line in moved:
            log.warning("%s", line)
        return Match(spec, game_map)
    except (MapError, MatchSetupError) as error:
        raise RefusedEpisodeError(str(error)) from None
