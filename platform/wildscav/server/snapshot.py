"""What the engine knows, as plain lists for the wire."""

from typing import TYPE_CHECKING

from wildscav.sdk.agent import MatchInfo, SupplyWave
from wildscav.server.deadlines import Clock
from wildscav.wire.observations import Snapshot

if TYPE_CHECKING:
    from wildscav_engine.match import Match


FIRST, LAST = "position", "gained"  # facts of a snapshot that the engine's agents have under the same name
OWN = Snapshot._fields[Snapshot._fields.index(FIRST) : Snapshot._fields.index(LAST) + 1]


class Senses:
    """Takes snapshots of a match.

    Each fact is one list for all seats, made in one go from the array that holds it; the arrays stay where
    they are for as long as the match lasts, so they are looked up once.

    Args:
        match: Any, at any moment.
    """

    def __init__(self, match: "Match") -> None:
        agents, matches = match.state.agents, match.state.matches
        self._match = match
        self._own = [getattr(agents, name)[0] for name in OWN]
        self._knows_target, self._target = agents.knows_target[0], matches.target[0]

    def take(self) -> Snapshot:
        """Return the match's present state."""
        match, boxes, seen = self._match, self._match.state.supplies, self._match.seen
        target = self._target.tolist()
        box_count = seen.supply_count[0].tolist()
        # Of the boxes, only those that somebody sees: a match can have thousands.
        slots = seen.supplies[0, :, : max(box_count)]
        facts = (  # in the order of a snapshot's fields
            match.step_number,
            match.frame,
            *[fact.tolist() for fact in self._own],
            seen.can_pick_up[0].tolist(),
            [target if knows else None for knows in self._knows_target.tolist()],
            seen.agent_count[0].tolist(),
            seen.agents[0].tolist(),
            box_count,
            boxes.serial[0].take(slots).tolist(),
            boxes.position[0].take(slots, axis=0).tolist(),
            boxes.quantity[0].take(slots).tolist(),
        )
        return Snapshot._make(facts)


def match_info(match: "Match", seat: int, clock: Clock) -> MatchInfo:
    """Return what a seat is told before the first step. The map's id and seed are not in it."""
    from wildscav_engine.rules import FRAMES_PER_SECOND

    spec, start = match.spec, match.start_info(seat)
    equipment = spec.equipment_of(seat)
    return MatchInfo(
        track=spec.track,
        seat=seat,
        seats=match.seats,
        team=start.team,
        time_limit=spec.time_limit,
        frames_per_action=spec.frames_per_action,
        frames_per_second=FRAMES_PER_SECOND,
        map_size=spec.map.config.size,
        start=start.position,
        target=start.target,
        supply_waves=tuple(SupplyWave(wave.time, wave.center, wave.radius) for wave in start.waves),
        seed=start.seed,
        step_budget=clock.step_budget,
        time_bank=clock.time_bank,
        target_distance=spec.rules.target_distance,
        pick_up_distance=spec.rules.pick_up_distance,
        supply_sight=spec.rules.supply_sight,
        clip_size=equipment.clip_size,
        start_health=equipment.health,
        respawns=match.track.respawns,
        supply_goal=spec.supply_goal or 0,
    )
