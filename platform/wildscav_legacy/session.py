"""A session with a client: a sequence of episodes, until the client closes it."""

import logging
import math
import os
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wildscav.errors import describe
from wildscav.terminal.console import counted
from wildscav_legacy.channel import Client
from wildscav_legacy.commander_pb2 import AgentCommand, GameState, GMCommand, Reply
from wildscav_legacy.episode import Episode, RefusedEpisodeError, read_episode
from wildscav_legacy.request_messages import START, Requests

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from wildscav_engine.maps import GameMap
    from wildscav_engine.simulation.match import Match
    from wildscav_engine.specs.match_spec import MatchSpec, Position

LONGEST_SUFFIX = 100  # characters

log = logging.getLogger("wildscav_legacy")


class Session:
    """Plays the episodes of one client."""

    def __init__(self, client: Client, records: Path) -> None:
        self._client, self._records = client, records
        self._episodes = 0
        self._unknown_ids: set[int] = set()  # ids without an agent, already logged in this episode

    def run(self) -> None:
        """Play the episodes that the client requests until it closes the session.

        Raises:
            ClientGoneError: The client has gone.
            RefusedEpisodeError: It requests an episode that cannot be played.
            TooLargeError: It does not accept messages as large as the episode needs.
        """
        reply = self._client.ask(START)
        while reply.game_state != GameState.CLOSE:
            if reply.game_state == GameState.RESET:
                reply = self._play(reply.gm_cmd)
            else:
                # There is no episode to update, so the client is asked again.
                log.warning("the client replies %d, but no episode is being played", reply.game_state)
                reply = self._client.ask(START)
        log.info("closed by the client after %s", counted(self._episodes, "episode"))

    def _play(self, command: GMCommand) -> Reply:
        """Play an episode, and return the reply that ends it."""
        self._episodes += 1
        self._unknown_ids.clear()
        episode = read_episode(command)
        match = self._match_of(episode)
        description = f"map {episode.map_id:03}, {match.track.name}, {counted(match.seats, 'agent')}"
        log.info("episode %d: %s, at most %g s", self._episodes, description, match.spec.time_limit)
        requests, began = Requests(match, episode), time.perf_counter()
        request, is_over = requests.next(), False
        reply = self._client.ask(request)
        while reply.game_state == GameState.UPDATE:
            # A client that goes on after the end is sent the last request again.
            if not is_over:
                match.step(self._actions(reply, episode))
                request, is_over = requests.next(), match.over
                if is_over:
                    self._end(episode, match, time.perf_counter() - began)
            reply = self._client.ask(request)
        if not is_over:
            self._end(episode, match, time.perf_counter() - began)
        return reply

    def _match_of(self, episode: Episode) -> "Match":
        """Return the match of an episode, with the engine prepared for it, which may take a while."""
        from wildscav_server.hosting.precompile import precompile

        with self._client.watched():
            precompile(())
            return match_of(episode)

    def _actions(self, reply: Reply, episode: Episode) -> "NDArray[np.float32]":
        """Return the actions in a reply; each unknown id is logged once per episode."""
        rows, unknown = read_actions(reply.agent_cmd_list, episode.seats)
        for unknown_id in set(unknown) - self._unknown_ids:
            self._unknown_ids.add(unknown_id)
            log.warning("there is no agent %d; its actions are ignored", unknown_id)
        return rows

    def _end(self, episode: Episode, match: "Match", seconds: float) -> None:
        """Log how an episode ended, and write its record, before the client learns of the end."""
        how = match.result().ending.replace("_", " ") if match.over else "interrupted"
        rate = match.step_number / seconds
        log.info("episode %d: %s after %d frames; %.0f actions/s", self._episodes, how, match.frame, rate)
        if episode.is_recorded:
            self._record(episode, match)

    def _record(self, episode: Episode, match: "Match") -> None:
        """Write the record of an episode, if it was played to its end."""
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
    """Return the match of an episode, or raise a RefusedEpisodeError if it cannot be set up."""
    from wildscav_engine.maps import MapError, load_map
    from wildscav_engine.simulation.match import Match, MatchSetupError

    try:
        game_map = load_map(episode.map_id)
        spec, moved = with_usable_places(episode, game_map)
        for line in moved:
            log.warning("%s", line)
        return Match(spec, game_map)
    except (MapError, MatchSetupError) as error:
        raise RefusedEpisodeError(str(error)) from None


def with_usable_places(episode: Episode, game_map: "GameMap") -> "tuple[MatchSpec, list[str]]":
    """Return the spec of an episode with usable starts and target, and a log line for each that was moved.

    The client's default start is the middle of the map, whatever is there, and the original refused no place.
    So a place where no agent can stand, or that it cannot leave, is replaced by the nearest valid location.
    """
    spec, moved = episode.spec, []

    def usable_or_none(place: "Position | None", name: str, reach: float | None) -> "Position | None":
        if place is None:
            return None
        usable = _nearest_usable(game_map, place, reach)
        if usable != place:
            moved.append(f"{name} {_text(place)} is not usable: {_text(usable)} is used instead")
        return usable

    starts = [
        usable_or_none(place, f"start_location of agent {agent}", None)
        for place, agent in zip(spec.start_of_seats, episode.ids, strict=True)
    ]
    target = usable_or_none(spec.target, "target_location", spec.rules.target_distance)
    if not moved:
        return spec, moved
    return spec.model_copy(update={"starts": tuple(starts), "target": target}), moved


def _nearest_usable(game_map: "GameMap", place: "Position", reach: float | None) -> "Position":
    """Return a place if it is usable, else the nearest of the map's locations that is."""
    from wildscav_engine.simulation.setup.starts import usable_place

    if (usable := usable_place(game_map, place, reach)) == place:
        return place
    locations = np.concatenate([game_map.indoor, game_map.outdoor])
    offsets = locations - np.array(place)
    for x, y, z in locations[np.argsort((offsets * offsets).sum(axis=1), kind="stable")].tolist():
        if usable_place(game_map, (x, y, z), reach) == (x, y, z):
            return x, y, z
    return usable


def _text(place: "Position") -> str:
    return f"({', '.join(f'{number:.2f}' for number in place)})"


def read_actions(
    commands: Iterable[AgentCommand], seats: Mapping[int, int]
) -> "tuple[NDArray[np.float32], list[int]]":
    """Return (A, FIELDS) the actions of all seats: none without a command; of two, the last one counts.

    A walk speed is clamped to 0 to 10 m/s, the range that the original's agents had.

    Returns:
        The rows, and the ids that belong to no agent.
    """
    from wildscav_engine.specs.actions import MAX_WALK_SPEED, Field, no_actions

    rows, unknown = no_actions(len(seats)), []
    for command in commands:
        seat = seats.get(command.id)
        if seat is None:
            unknown.append(command.id)
            continue
        speed = command.walk_speed
        # The fields up to the last one that the original had.
        rows[seat, : Field.RELOAD + 1] = (
            command.walk_dir,
            speed if math.isnan(speed) else min(MAX_WALK_SPEED, max(0.0, speed)),
            command.turn_left_right_delta,
            command.look_up_down_delta,
            command.jump,
            command.collect,
            command.shoot_gun,
            command.reload,
        )
    return rows, unknown
