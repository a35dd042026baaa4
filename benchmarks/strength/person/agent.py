"""A model of a person at the mouse, in place of people: late, and never quite exact.

It sees everybody as they were ``REACTION`` ago, as people take 0.2 to 0.3 s from a sight to a movement (Woods
et al., "Factors influencing the latency of simple reaction time", Frontiers in Human Neuroscience 9, 2015).
A movement of the mouse misses by a share of its length, as the noise of muscles grows with their force
(Harris and Wolpert, "Signal-dependent noise determines motor planning", Nature 394, 1998), and a hand at rest
still trembles. It fights everybody that it sees, and stands still to shoot. Otherwise it looks around where
it walks, and remembers the boxes that it has seen.
"""

import math
from collections import deque

import numpy as np

from wildscav import Action, Agent, MatchInfo, Observation, Vector
from wildscav.geometry import BODY_RADIUS, direction_to, flat_distance, pitch_to, turn_to
from wildscav.skills.aiming import AIM_HEIGHT, Aim, enemies_in_sight, max_turn_of
from wildscav.skills.fighting import fighting_action
from wildscav.skills.gathering import Gathering
from wildscav.skills.walking import Walk

REACTION = 0.3  # s
MISS = 0.1  # standard deviation of a movement's end, as a share of the movement
TREMBLE = 0.5  # degrees, standard deviation
STEPS_TO_TARGET = 2  # steps that a movement takes
SURE = 1.5  # half widths of a body within which it shoots
SWEEP, SWEEPS = 60.0, 2.5  # degrees to either side of its way that it looks, and s for there and back


class Person(Agent):
    """Fights whom it sees, and gathers in between."""

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""
        self.match = match
        self.random = np.random.default_rng(match.seed)
        self.gathering = Gathering(match)
        self.seen: deque[Observation] = deque(maxlen=1 + round(REACTION / match.step_time))

    def act(self, seen: Observation) -> Action:
        """Aim at the nearest enemy that was seen a moment ago, or gather."""
        self.gathering.look(seen)
        if not seen.alive:
            self.seen.clear()
            return Action()
        self.seen.append(seen)
        enemies = enemies_in_sight(self.seen[0], self.match.team)
        walk = Walk(0.0, 0.0) if enemies else self.gathering.walk(seen)
        aim = self.aim(seen, enemies[0].position) if enemies else self.look_about(seen, walk)
        return fighting_action(seen, self.match, walk, aim, bool(enemies))

    def aim(self, seen: Observation, enemy: Vector) -> Aim:
        """Move the view to where an enemy was, and shoot if it seems to be there."""
        chest = (enemy[0], enemy[1] + AIM_HEIGHT, enemy[2])
        turn = turn_to(seen.yaw, direction_to(seen.position, chest))
        look = pitch_to(seen.position, chest) - seen.pitch
        half_width = math.degrees(math.atan2(BODY_RADIUS, flat_distance(seen.position, chest)))
        is_on = abs(turn) < SURE * half_width and abs(look) < SURE * 2.0 * half_width
        return Aim(self.moved(turn), self.moved(look), is_on)

    def look_about(self, seen: Observation, walk: Walk) -> Aim:
        """Look along the way, and now and then to its sides."""
        side = SWEEP * math.sin(math.tau * seen.time / SWEEPS)
        return Aim(self.moved(turn_to(seen.yaw, walk.direction + side)), self.moved(-seen.pitch))

    def moved(self, wanted: float) -> float:
        """Return the turn, degrees a frame, of a hand that wants to turn the view so many degrees."""
        step = wanted / STEPS_TO_TARGET
        end = step + self.random.normal(0.0, TREMBLE + MISS * abs(step))
        frames, most = self.match.frames_per_action, max_turn_of(self.match)
        return float(np.clip(end / frames, -most, most))
