// An agent in JavaScript: walks to the target and slips around obstacles, which it sees with a LIDAR.

import { playSeat } from "./seat.js";
import { Steering } from "./steering.js";

const FULL_SPEED = 10; // m/s
const MAX_TURN = 4; // degrees per frame

/** What `playSeat` needs: `reset` before the match, and `act` for each observation. */
class HomingJs {
  /** Gets ready for a match. */
  reset(match) {
    this.match = match;
    this.steering = new Steering();
  }

  /** Returns the fields of the Action that answers an observation. Fields that are not set are 0 or false. */
  act(observation) {
    const target = observation.target ?? this.match.target;
    const { direction, jump } = this.steering.toward(observation, target);
    return {
      walk_direction: direction,
      walk_speed: FULL_SPEED,
      turn: this.turnTo(direction, observation.yaw),
      look: -observation.pitch / this.match.frames_per_action,
      jump,
    };
  }

  /** Returns the turn per frame that faces a compass direction, degrees. */
  turnTo(direction, yaw) {
    const turn = ((((direction - yaw + 180) % 360) + 360) % 360) - 180;
    return Math.max(-MAX_TURN, Math.min(MAX_TURN, turn / this.match.frames_per_action));
  }
}

playSeat(new HomingJs(), "homing-js", "1.0.0");
