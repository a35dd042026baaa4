"""What lists and turns without limits allow in a few lines: shoot the nearest, grab, and hide at the end."""

from wildscav import Action, Agent, MatchInfo, Observation
from wildscav.geometry import direction_to, pitch_to, turn_to

HIDE = 30.0  # s before the end from which it runs into a corner


class Gunner(Agent):
    """Turns to the nearest enemy and shoots; walks to the nearest box, or to where supplies appear."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.match = match

    def act(self, seen: Observation) -> Action:
        """Walk, turn and shoot."""
        frames, here, edge = self.match.frames_per_action, seen.position, 0.45 * self.match.map_size
        waves = [wave for wave in self.match.supply_waves if wave.time <= seen.time + 5.0]
        goal = (waves[-1].center[0], here[1], waves[-1].center[1]) if waves else (0.0, here[1], 0.0)
        if self.match.time_limit - seen.time < HIDE:
            goal = (edge if here[0] > 0 else -edge, here[1], edge if here[2] > 0 else -edge)
        elif seen.supply_boxes:
            goal = seen.supply_boxes[0].position
        walk = {"walk_direction": direction_to(here, goal), "walk_speed": 10.0, "jump": seen.step % 10 == 0}
        enemies = [agent for agent in seen.agents if agent.team != self.match.team and not agent.invincible]
        if not enemies:
            return Action(**walk, turn=9.0, look=-seen.pitch / frames, pick_up=True, reload=seen.clip < 5)
        (x, y, z), (east, _, north) = enemies[0].position, enemies[0].velocity
        ahead = (x + 0.1 * (east - seen.velocity[0]), y + 1.0, z + 0.1 * (north - seen.velocity[2]))
        turn, look = turn_to(seen.yaw, direction_to(here, ahead)), pitch_to(here, ahead) - seen.pitch
        rest = {"pick_up": True, "shoot": abs(turn) < 5.0, "reload": seen.clip == 0}
        return Action(**walk, turn=turn / frames, look=look / frames, **rest)
