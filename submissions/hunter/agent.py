"""The agent that gathers, and fights whoever comes into sight."""

from aim import Order, aim_at, look_around, nearest_enemy
from steering import Boxes, Search, Steering, Vector, effort

from wildscav import Action, Agent, MatchInfo, Observation, SupplyBox, VisibleAgent
from wildscav.geometry import flat_distance

FULL_SPEED = 10.0  # m/s
START_UP = 3.0  # m, a box takes time however near it is
WORTH = 0.6  # how much the quantity counts, 0 to 1
CHASE_RANGE = 25.0  # m, an enemy this near is followed when there is no box to fetch


class Hunter(Agent):
    """Walks to supplies, and aims and shoots while it walks."""

    def reset(self, match: MatchInfo) -> None:
        """Remember the match's facts."""
        self.match = match
        self.steering = Steering(match.seed)
        self.search = Search(match)
        self.boxes = Boxes(effort_by_worth)

    def act(self, observation: Observation) -> Action:
        """Walk one way and look another: supplies and enemies are rarely in the same direction."""
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
        """Return where to look."""
        frames = self.match.frames_per_action
        return look_around(observation, frames) if enemy is None else aim_at(observation, enemy, frames)

    def goal(self, observation: Observation, enemy: VisibleAgent | None) -> Vector:
        """Return where to go: the target, a box, an enemy near by, or on with the search."""
        if observation.target is not None:
            return observation.target
        box = self.boxes.choose(observation)
        if box is not None:
            return box
        if enemy is not None and flat_distance(observation.position, enemy.position) < CHASE_RANGE:
            return enemy.position
        return self.search.next_place(observation)

    def wants_reload(self, observation: Observation, enemy: VisibleAgent | None) -> bool:
        """Reload an empty clip at once, a low one while nobody is in sight."""
        if observation.reloading or observation.spare_ammo == 0:
            return False
        return observation.clip == 0 or (enemy is None and observation.clip < self.match.clip_size * 0.6)


def effort_by_worth(here: Vector, box: SupplyBox) -> float:
    """Return how hard a box is to have for what is in it: a rich one is worth a longer way."""
    return (effort(here, box) + START_UP) / box.quantity**WORTH
