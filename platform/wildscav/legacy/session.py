"""A session with a client: episode after episode, until it closes."""

import logging
import os
import time
from pathlib import Path
from typing import TYPE_CHECKING

from wildscav.console import counted
from wildscav.errors import describe
from wildscav.legacy.actions import read_actions
from wildscav.legacy.channel import Client
from wildscav.legacy.commander_pb2 import GameState, GMCommand, Reply
from wildscav.legacy.episode import Episode, RefusedEpisodeError, read_episode
from wildscav.legacy.places import settle_places
from wildscav.legacy.requests import START, Requests

if TYPE_CHECKING:
    from wildscav_engine.match import Match

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

    def run(self) -> None:
        """Play what the client asks for until it closes.

        Raises:
            ClientGoneError: It is there no longer.
            RefusedEpisodeError: It asks for what cannot be.
        """
        reply = self._client.ask(START)
        while reply.game_state != GameState.CLOSE:
            if reply.game_state == GameState.RESET:
                reply = self._play(reply.gm_cmd)
            else:
                # There is no episode, so there is nothing to do but to ask again.
                name = GameState.Name(reply.game_state).lower()
                log.warning("the client replies %s, but no episode is being played", name)
                reply = self._client.ask(START)
        log.info("closed by the client after %s", counted(self._episodes, "episode"))

    def _play(self, command: GMCommand) -> Reply:
        """Play an episode, and return the reply that ends it."""
        self._episodes += 1
        episode = read_episode(command)
        match = match_of(episode)
        requests = Requests(match, episode)
        seats = {number: seat for seat, number in enumerate(episode.ids)}
        log.info(
            "episode %d: map %03d, %s, %d agents, at most %g s",
            self._episodes,
            episode.map_id,
            match.track.name,
            match.seats,
            match.spec.time_limit,
        )
        began = time.perf_counter()
        reply = self._client.ask(requests.next())
        while reply.game_state == GameState.UPDATE and not match.over:
            rows, unknown = read_actions(reply.agent_cmd_list, seats)
            if unknown:
                log.warning("there is no agent %s", ", ".join(map(str, unknown)))
            match.step(rows)
            reply = self._client.ask(requests.next())
        self._end(match, time.perf_counter() - began)
        if episode.is_recorded:
            self._record(episode, match)
        return reply

    def _end(self, match: "Match", seconds: float) -> None:
        """Say how an episode ended."""
        how = match.result().ending.replace("_", " ") if match.over else "broken off"
        rate = match.step_number / seconds
        log.info("episode %d: %s after %d frames; %.0f actions/s", self._episodes, how, match.frame, rate)

    def _record(self, episode: Episode, match: "Match") -> None:
        """Write the record of an episode that was played to its end."""
        from wildscav_engine.record import SUFFIX, write_record

        if not match.over:
            log.warning("no record of episode %d: it was broken off", self._episodes)
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
    from wildscav_engine.match import Match, MatchSetupError

    try:
        game_map = load_map(episode.map_id)
        spec, moved = settle_places(episode, game_map)
        for line in moved:
            log.warning("%s", line)
        return Match(spec, game_map)
    except (MapError, MatchSetupError) as error:
        raise RefusedEpisodeError(str(error)) from None
