// The views that follow a seat: through its eyes, and from behind.

import { Vector3 } from "three";
import type { Course, SeatState } from "../data/course";
import type { Obstacles } from "../view/obstacles";
import { type Pose, radians } from "./orbit";

const EYE = 1.5; // m over the soles
// Of the camera behind: its distance, what it looks over, and how it looks down, as in the engine's videos.
const BEHIND = 4.6;
const HEAD = 1.75;
const TILT = 14;
const SHOULDER = 0.55; // m to the right
const CLEARANCE = 0.35; // m, kept from walls
const NEAREST = 2.4; // m from the head; where walls are nearer, they are left out
const TURN = 25; // frames before and after, over whose mean it turns
const PIECES = 8; // of them
const FALLEN = 26; // degrees that it looks down more at the dead
const OPENING = 0.9; // s in which it goes back by about two thirds of the way
const ARRIVED = 0.05; // m
const JUMP = 50; // frames beyond which it does not glide

export function atTheEyes(state: SeatState): Pose {
  const { x, y, z, yaw, pitch } = state;
  return { x, y: y + EYE, z, yaw, pitch };
}

export class Follower {
  readonly focus = new Vector3(); // m, what it looks at
  isBlocked = false; // whether something stands between the camera and that
  isGliding = false; // whether it has yet to go back
  private distance = BEHIND; // m, from the head
  private seat = -1;
  private frame = 0;

  constructor(
    private readonly course: Course,
    private readonly obstacles: Obstacles,
  ) {}

  // The pose behind a seat, some seconds after the last picture.
  pose(seat: number, frame: number, seconds: number): Pose {
    const state = this.course.at(seat, frame);
    const { yaw, pitch: look } = this.smoothed(seat, frame, state);
    const pitch = TILT + 0.4 * look + (state.health > 0 ? 0 : FALLEN);
    const [sin, cos] = [Math.sin(radians(yaw)), Math.cos(radians(yaw))];
    const y = state.y + HEAD;
    const aside = this.obstacles.free(state.x, y, state.z, [cos, 0, -sin], SHOULDER + CLEARANCE);
    const shoulder = Math.max(0, aside - CLEARANCE);
    const [x, z] = [state.x + shoulder * cos, state.z - shoulder * sin];
    const level = Math.cos(radians(pitch));
    const back: [number, number, number] = [-sin * level, Math.sin(radians(pitch)), -cos * level];
    const room = this.obstacles.free(x, y, z, back, BEHIND + CLEARANCE) - CLEARANCE;
    this.isBlocked = room < NEAREST;
    this.focus.set(state.x, state.y + 1, state.z);
    const isJump = seat !== this.seat || Math.abs(frame - this.frame) > JUMP;
    const share = isJump || room < this.distance ? 1 : 1 - Math.exp(-seconds / OPENING);
    const wanted = Math.max(NEAREST, Math.min(BEHIND, room));
    this.distance += (wanted - this.distance) * share;
    this.isGliding = wanted - this.distance > ARRIVED;
    [this.seat, this.frame] = [seat, frame];
    const far = this.distance;
    return { x: x + back[0] * far, y: y + back[1] * far, z: z + back[2] * far, yaw, pitch };
  }

  // Yaw and pitch over some time before and after, as long as the seat has not moved to another place.
  private smoothed(seat: number, frame: number, now: SeatState): { yaw: number; pitch: number } {
    let [yaw, pitch, count] = [0, 0, 0];
    for (let piece = -PIECES; piece <= PIECES; piece++) {
      const state = this.course.at(seat, frame + (piece * TURN) / PIECES);
      if (Math.abs(state.x - now.x) + Math.abs(state.z - now.z) > 8) continue;
      yaw += state.yaw;
      pitch += state.pitch;
      count++;
    }
    return { yaw: yaw / count, pitch: pitch / count };
  }
}
