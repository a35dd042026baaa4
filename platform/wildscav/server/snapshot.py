"""What the engine knows, as plain lists for the wire."""

from typing import TYPE_CHECKING

from wildscav.sdk.agent import MatchInfo, SupplyWave
from wildscav.server.deadlines import Clock
from wildscav.wire.observations import Snapshot

if TYPE_CHECKING:
    from wildscav_engine.match import Match


def take_snapshot(match: "Match") -> Snapshot:
    """Return a match's present state; each array is converted once, not element by element."""
    agents, boxes, seen = match.state.agents, match.state.supplies, match.seen
    own = {name: getattr(agents, name)[0].tolist() for name in _OWN}
    target = match.state.matches.target[0].tolist()
    # Of the boxes, only those that somebody sees: a match can have thousands.
    slots = seen.supplies[0, :, : seen.supply_count[0].max()]
    return Snapshot(
        step=match.step_number,
        frame=match.frame,
        target=[target if knows else None for knows in agents.knows_target[0].tolist()],
        can_pick_up=seen.can_pick_up[0].tolist(),
        agent_count=seen.agent_count[0].tolist(),
        agents=seen.agents[0].tolist(),
        box_count=seen.supply_count[0].tolist(),
        box_serial=boxes.serial[0][slots].tolist(),
        box_position=boxes.position[0][slots].tolist(),
        box_quantity=boxes.quantity[0][slots].tolist(),
        **own,
    )


# Facts of agents that have one name in the engine's state and in the snapshot.
_OWN = (
    *("position", "velocity", "team", "yaw", "pitch", "on_ground", "in_water", "health"),
    *("clip", "spare_ammo", "reload_left", "fired", "hit_seat", "hit_by_seat"),
    *("invincible_left", "respawn_left", "supplies", "gained"),
)


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
