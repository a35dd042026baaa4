"""The events of a step as an ``EventInfo``, found by comparing the states before and after it."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_legacy.commander_pb2 import (
    EventAgent,
    EventAgentBeHit,
    EventAgentDead,
    EventAgentRefresh,
    EventAgentReloadSuccess,
    EventGameStart,
    EventGetSupplySuccess,
    EventInfo,
    EventPlayerSettleInfo,
    EventSettle,
    EventSupplyRefresh,
    EventSystem,
    Vector3,
)
from wildscav_legacy.episode import MODES, Episode

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match
    from wildscav_engine.simulation.state import Agents, Supplies


class PreviousState(NamedTuple):
    """The parts of a state that are compared with the next state."""

    position: NDArray[np.float64]  # (A, 3) m
    health: NDArray[np.int32]  # (A,)
    deaths: NDArray[np.int32]  # (A,)
    reload_left: NDArray[np.int32]  # (A,)
    serial: NDArray[np.int32]  # (S,)
    quantity: NDArray[np.int32]  # (S,)
    next_serial: int


class Refresh(NamedTuple):
    """A wave of supplies after the start."""

    number: int  # from 1
    frame: int  # in which it appears
    center: tuple[float, float]  # m, x and z
    boxes: int


class Events:
    """Reports the events of one match, which is before its first step."""

    def __init__(self, match: "Match", episode: Episode) -> None:
        self._match, self._ids = match, episode.ids
        self._mode = MODES[match.track.name]
        self._refreshes = _refreshes(match)
        self._before: PreviousState | None = None

    def next(self) -> EventInfo:
        """Return the events since the last call; the first call returns the start of the match."""
        match, before = self._match, self._before
        info = EventInfo(timeStep=match.frame)
        self._add_match_events(info.event_system, starts=before is None)
        if before is not None:
            info.event_agentInfos.extend(self._agent_events(before))
        if not info.event_system.ByteSize():
            info.ClearField("event_system")
        self._before = _snapshot(match)
        return info

    def _add_match_events(self, system: EventSystem, *, starts: bool) -> None:
        match = self._match
        if starts:
            system.event_game_start.CopyFrom(EventGameStart(gameMode=self._mode))
        if self._refreshes and self._refreshes[0].frame <= match.frame:
            # A message has room for one wave; further waves of the same time follow in the next messages.
            number, _, (x, z), boxes = self._refreshes.pop(0)
            place = Vector3(x=x, y=0.0, z=z)
            system.event_supplyrefrsh.CopyFrom(EventSupplyRefresh(pos=place, count=boxes, id=number))
        if match.over:
            system.event_settle.CopyFrom(self._settlement())

    def _settlement(self) -> EventSettle:
        """Return the results of all agents, and once more those of the first agent."""
        from wildscav_engine.specs.rules import FRAME

        agents = self._match.state.agents
        ranks = _ranks(agents.supplies[0])
        players = [
            EventPlayerSettleInfo(
                supply_count=int(agents.supplies[0, seat]),
                rank=int(ranks[seat]),
                move_distance=float(agents.walked[0, seat]),
                kill_count=int(agents.kills[0, seat]),
                dead_count=int(agents.deaths[0, seat]),
            )
            for seat in range(self._match.seats)
        ]
        return EventSettle(
            gameMode=self._mode,
            elapsed_time=self._match.frame * FRAME,
            move_distance=players[0].move_distance,
            supply_count=players[0].supply_count,
            event_player_infos=players,
        )

    def _agent_events(self, before: PreviousState) -> Iterator[EventAgent]:
        """Yield the events of agents, one event in each message."""
        agents = self._match.state.agents
        ranks = _ranks(agents.supplies[0]).tolist()
        for seat, event in (
            *_hits(agents, before),
            *_deaths_and_returns(agents, before),
            *_reloads(agents, before),
            *_pick_ups(self._match, before),
        ):
            event.player_id, event.supply_num_rank = self._ids[seat], ranks[seat]
            if event.HasField("event_agent_beHited"):
                event.event_agent_beHited.fire_id = self._ids[event.event_agent_beHited.fire_id]
            yield event


SeatEvents = Iterator[tuple[int, EventAgent]]  # each with its seat


def _hits(agents: "Agents", before: PreviousState) -> SeatEvents:
    """Yield the agents that were hit, with the shooter's seat; invincible agents take no damage."""
    for shooter in np.nonzero(agents.hit_seat[0] >= 0)[0].tolist():
        victim = int(agents.hit_seat[0, shooter])
        is_hurt = (
            agents.health[0, victim] != before.health[victim]
            or agents.deaths[0, victim] != before.deaths[victim]
        )
        damage = int(agents.shot_damage[0, shooter]) if is_hurt else 0
        yield victim, EventAgent(event_agent_beHited=EventAgentBeHit(damageValue=damage, fire_id=shooter))


def _deaths_and_returns(agents: "Agents", before: PreviousState) -> SeatEvents:
    died = agents.deaths[0] > before.deaths
    for seat in np.nonzero(died)[0].tolist():
        # Dead agents stay where they died; one that has respawned already died about where it was before.
        place = agents.position[0, seat] if agents.health[0, seat] <= 0 else before.position[seat]
        yield seat, EventAgent(event_agent_dead=EventAgentDead(pos=_vector(place)))
    for seat in np.nonzero((agents.health[0] > 0) & (died | (before.health <= 0)))[0].tolist():
        place = agents.position[0, seat]
        yield seat, EventAgent(event_agent_refresh=EventAgentRefresh(pos=_vector(place)))


def _reloads(agents: "Agents", before: PreviousState) -> SeatEvents:
    done = (before.reload_left > 0) & (agents.reload_left[0] == 0) & (agents.deaths[0] == before.deaths)
    for seat in np.nonzero(done)[0].tolist():
        yield seat, EventAgent(event_agent_reload_success=EventAgentReloadSuccess())


def _pick_ups(match: "Match", before: PreviousState) -> SeatEvents:
    """Yield the boxes that were picked up, each by the nearest agent that gained at least as much."""
    agents, supplies = match.state.agents, match.state.supplies
    left = agents.gained[0].copy()
    if not left.any():
        return
    for slot, quantity in _taken(supplies, before):
        enough = np.nonzero(left >= max(1, quantity))[0]
        if not len(enough):
            continue
        place = supplies.position[0, slot]
        offsets = agents.position[0, enough] - place
        seat = int(enough[np.argmin((offsets * offsets).sum(axis=1))])
        # A box that was dropped and picked up in the same step is credited with the rest of the agent's gain.
        count = quantity or int(left[seat])
        left[seat] -= count
        yield (
            seat,
            EventAgent(
                event_get_supply_success=EventGetSupplySuccess(
                    supply_id=int(supplies.serial[0, slot]), supply_count=count, pos=_vector(place)
                )
            ),
        )


def _taken(supplies: "Supplies", before: PreviousState) -> list[tuple[int, int]]:
    """Return the slots of boxes that were picked up, and their quantities; 0 if the quantity is unknown."""
    is_empty, same = supplies.quantity[0] == 0, supplies.serial[0] == before.serial
    known = np.nonzero(is_empty & same & (before.quantity > 0))[0].tolist()
    # Boxes that were dropped and picked up since the previous state.
    new = np.nonzero(is_empty & (supplies.serial[0] >= before.next_serial))[0].tolist()
    return [(slot, int(before.quantity[slot])) for slot in known] + [(slot, 0) for slot in new]


def _snapshot(match: "Match") -> PreviousState:
    agents, supplies = match.state.agents, match.state.supplies
    return PreviousState(
        *(agents.position[0].copy(), agents.health[0].copy(), agents.deaths[0].copy()),
        *(agents.reload_left[0].copy(), supplies.serial[0].copy(), supplies.quantity[0].copy()),
        int(match.state.matches.next_serial[0]),
    )


def _refreshes(match: "Match") -> list[Refresh]:
    """Return the waves of supplies after the start, ordered by time."""
    from wildscav_engine.specs.rules import FRAMES_PER_SECOND

    appears = match.state.supplies.appears[0][match.state.supplies.quantity[0] > 0]
    found = []
    for number, wave in enumerate(match.start_info(0).waves):
        frame = round(wave.time * FRAMES_PER_SECOND)
        if frame > 0:
            found.append(Refresh(number, frame, wave.center, int((appears == frame).sum())))
    return found


def _ranks(supplies: NDArray[np.int32]) -> NDArray[np.int64]:
    """Return (A,) the rank of each agent by its supplies: 1 plus the number of agents that carry more."""
    ranks: NDArray[np.int64] = 1 + (supplies[np.newaxis] > supplies[:, np.newaxis]).sum(axis=1)
    return ranks


def _vector(place: NDArray[np.float64] | NDArray[np.float32]) -> Vector3:
    x, y, z = place.tolist()
    return Vector3(x=x, y=y, z=z)
