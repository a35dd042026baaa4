// Walking to a place: straight where the way is free, else along the obstacle on one side of it.

const LOOK_AHEAD = 3; // m of the way that must be free
const HALF_WIDTH = 0.55; // m; the body's radius is 0.45 m
const SCAN = 10; // degrees between the directions that are tried beside the direct one
const WIDEST = 170; // degrees; the farthest of them
const PATIENCE = 60; // steps on one side of an obstacle without getting nearer to the goal
const PROGRESS = 2; // m nearer to the goal than ever before
const TRAIL = 6; // steps over which movement is measured
const STUCK = 1.2; // m; who moves less in so many steps is stuck
const JUMPS = 4; // steps of jumping, if stuck
const DETOUR = 10; // steps of walking away, if jumping does not help; more each time

/** Walks towards goals. It is deterministic: the same observations give the same walk. */
export class Steering {
  constructor() {
    this.trail = []; // the last positions
    this.nearest = Infinity; // m to the goal at the least
    this.waited = 0; // steps since that was so
    this.side = 0; // of the obstacle that is being passed: 1 to the right, -1 to the left, 0 for none
    this.stuck = 0; // times in a row
    this.jumping = 0; // steps left
    this.detour = 0; // steps left
    this.offset = 0; // degrees between the detour and the direct way
  }

  /** Returns the compass direction to walk in (degrees), and whether to jump. */
  toward(observation, goal) {
    const { position, yaw, in_water: inWater, sensors } = observation;
    this.noticeProgress(distance(position, goal));
    this.noticeBeingStuck(position, inWater);
    const direct = directionTo(position, goal);
    if (this.detour > 0) {
      this.detour -= 1;
      return { direction: direct + this.offset, jump: this.detour % 8 === 0 };
    }
    if (this.jumping > 0) {
      this.jumping -= 1;
      return { direction: direct, jump: true };
    }
    const obstacles = hits(sensors.lidar.numbers, yaw);
    return { direction: this.slip(direct, Math.min(LOOK_AHEAD, distance(position, goal)), obstacles), jump: false };
  }

  /** Returns the free direction that is nearest to the direct one, on the chosen side of the obstacle. */
  slip(direct, ahead, obstacles) {
    if (isFree(direct, ahead, obstacles)) {
      this.side = 0;
      return direct;
    }
    // It keeps to the side that it once chose; otherwise it would turn back and forth before a wall.
    const sides = this.side === 0 ? [1, -1] : [this.side];
    for (let angle = SCAN; angle <= WIDEST; angle += SCAN) {
      for (const side of sides) {
        if (isFree(direct + side * angle, LOOK_AHEAD, obstacles)) {
          this.side = side;
          return direct + side * angle;
        }
      }
    }
    return direct; // the body slides along what it walks into, or gets stuck and makes a detour
  }

  noticeProgress(left) {
    this.waited += 1;
    if (left < this.nearest - PROGRESS) {
      this.nearest = left;
      this.waited = this.stuck = 0;
    } else if (this.waited > PATIENCE * (1 + this.stuck)) {
      // This side leads nowhere: try the other one, longer.
      this.side = -this.side;
      this.stuck += 1;
      this.waited = 0;
    }
  }

  noticeBeingStuck(position, inWater) {
    this.trail.push(position);
    if (this.trail.length <= TRAIL) {
      return;
    }
    const moved = distance(this.trail.shift(), position);
    if (moved > STUCK * (inWater ? 0.5 : 1)) {
      return;
    }
    this.trail = [];
    this.stuck += 1;
    if (this.stuck === 1) {
      this.jumping = JUMPS;
      return;
    }
    // To the left and to the right in turn, at angles from 60 to 150 degrees.
    this.offset = (this.stuck % 2 === 0 ? 1 : -1) * (60 + ((this.stuck * 35) % 91));
    this.detour = Math.min(DETOUR + 5 * this.stuck, 60);
    this.jumping = 0;
  }
}

/** Returns the compass direction and distance (degrees, m) of everything that the LIDAR hits nearby. */
function hits(ring, yaw) {
  const found = [];
  ring.forEach((away, column) => {
    if (away < LOOK_AHEAD + 1) {
      found.push({ direction: yaw + (column * 360) / ring.length, away });
    }
  });
  return found;
}

/** Returns whether nothing is in the way of a body that walks so far (m) in a direction (degrees). */
function isFree(direction, ahead, obstacles) {
  return obstacles.every((hit) => {
    const angle = ((hit.direction - direction) * Math.PI) / 180;
    const forward = hit.away * Math.cos(angle);
    return forward <= 0 || forward > ahead || Math.abs(hit.away * Math.sin(angle)) > HALF_WIDTH;
  });
}

/** Returns the compass direction from one place to another, degrees: 0 is north (+z), 90 is east (+x). */
function directionTo(from, to) {
  return (Math.atan2(to.x - from.x, to.z - from.z) * 180) / Math.PI;
}

/** Returns the horizontal distance of two places, m. */
function distance(one, other) {
  return Math.hypot(other.x - one.x, other.z - one.z);
}
