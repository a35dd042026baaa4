"""An agent that gathers supplies, and fights enemies in sight."""

from aim import Order, aim_at, look_around, nearest_enemy

from wildscav import Action, Agent, MatchInfo, Observation, SupplyBox, Vector, VisibleAgent
from wildscav.geometry import flat_distance
from wildscav.skills.scouting import Scouting
from wildscav.skills.searching import Boxes, Search, effort
from wildscav.skills.steering import Steering
from wildscav.skills.zone import SafeZone, safe_zone

FULL_SPEED = 10.0  # m/s
START_UP = 3.0  # m, added to the distance of every box, because even a near one takes time
WORTH = 0.6  # weight of the quantity, 0 to 1
CHASE_RANGE = 25.0  # m, within which an enemy is followed if there is no box to fetch


class Hunter(Agent):
    """Walks to supplies, and aims and shoots while it walks."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.match = match
        self.steering = Steering(match.seed)
        self.search: Search | Scouting = Search(match) if match.supply_waves else Scouting(match)
        self.boxes = Boxes(effort_by_worth)

    def act(self, observation: Observation) -> Action:
        """Walk to supplies while facing enemies, which are rarely in the same direction."""
        enemy = nearest_enemy(observation, self.match.team)
        order = self.order(observation, enemy)
        direction, jump = self.steering.toward(observation, self.goal(observation, enemy))
        return Action(
            walk_direction=direction,
            walk_speed=FULL_SPEED,
            turn=order.turn,
            look=order.look,
            jump=jump,
            pick_up=observation.can_pick_up,
            shoot=order.shoot,
            reload=self.wants_reload(observation, enemy),
        )

    def order(self, observation: Observation, enemy: VisibleAgent | None) -> Order:
        """Return where to look, and whether to shoot."""
        frames = self.match.frames_per_action
        return look_around(observation, frames) if enemy is None else aim_at(observation, enemy, frames)

    def goal(self, observation: Observation, enemy: VisibleAgent | None) -> Vector:
        """Return where to go: into the safe zone, to the target, or to the prey."""
        zone = safe_zone(observation)
        if not zone.is_safe(observation.position):
            return zone.next.center
        if observation.target is not None:
            return observation.target
        prey = self.prey(observation, enemy, zone)
        return prey if zone.is_safe(prey) else zone.next.center

    def prey(self, observation: Observation, enemy: VisibleAgent | None, zone: SafeZone) -> Vector:
        """Return the position of a box or of a nearby enemy, or the next place of the search."""
        box = self.boxes.choose(observation, zone.is_safe)
        if box is not None:
            return box
        if enemy is not None and flat_distance(observation.position, enemy.position) < CHASE_RANGE:
            return enemy.position
        return self.search.next_place(observation)

    def wants_reload(self, observation: Observation, enemy: VisibleAgent | None) -> bool:
        """Return whether to reload: an empty clip at once, a low one while no enemy is in sight."""
        if observation.reloading or observation.spare_ammo == 0:
            return False
        return observation.clip == 0 or (enemy is None and observation.clip < self.match.clip_size * 0.6)


def effort_by_worth(here: Vector, box: SupplyBox) -> float:
    """Return the effort to fetch a box relative to its worth: a rich box is worth a longer walk."""
    return (effort(here, box) + START_UP) / box.quantity**WORTH
