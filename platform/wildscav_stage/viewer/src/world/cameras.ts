// The cameras of all views, in the frame of three.js, whose z points south.

import { type Camera, type Matrix4, OrthographicCamera, PerspectiveCamera, type Vector3 } from "three";
import type { Course } from "../data/course";
import type { GameMap } from "../data/map";
import type { View } from "../stage";
import { MapView } from "../view/map_view";
import type { Moment } from "../view/moment";
import { Obstacles } from "../view/obstacles";
import { atTheEyes, Follower } from "./followers";
import { Orbit, type Pose, radians } from "./orbit";
import type { Shared } from "./shared";

const FAR = 300; // m, where the haze hides everything to those on the ground
const ACROSS = 75; // degrees, the field of view of the engine's cameras in a picture of 16 : 9
const NARROWEST = 52; // degrees across, in an upright picture
const HIGH = 600; // m, of the camera above

export interface Shown {
  camera: Camera;
  hidden: number | null; // the seat whose body and name are not shown
  isFromAbove: boolean;
  across: number; // m in view from above; 0 in other views
  focus: Vector3 | null; // m, what must be seen though something stands before it
}

export class Cameras {
  readonly orbit: Orbit;
  readonly mapView: MapView;
  private readonly follower: Follower;
  private readonly perspective = new PerspectiveCamera();
  private readonly orthographic = new OrthographicCamera();

  constructor(
    private readonly map: GameMap,
    course: Course,
    private readonly shared: Shared,
  ) {
    this.orbit = new Orbit(map);
    this.mapView = new MapView(map.size);
    this.follower = new Follower(course, new Obstacles(map));
    for (const camera of [this.perspective, this.orthographic]) camera.rotation.order = "YXZ";
  }

  // Whether the camera behind a seat goes back, even while nothing else moves.
  get isGliding(): boolean {
    return this.follower.isGliding;
  }

  // Place the camera of a view, for a canvas of so many CSS pixels.
  place(view: View, moment: Moment, width: number, height: number, seconds: number): Shown {
    const { kind, seat } = view;
    if (kind === "above") return this.placeAbove(width, height);
    if (kind === "eyes") {
      this.look(atTheEyes(moment.states[seat]), width / height, 0.08, FAR, view.across, view.tall);
      return { camera: this.perspective, hidden: seat, isFromAbove: false, across: 0, focus: null };
    }
    if (kind === "behind") {
      this.look(this.follower.pose(seat, moment.frame, seconds), width / height, 0.1, FAR);
      const focus = this.follower.isBlocked ? this.follower.focus : null;
      return { camera: this.perspective, hidden: null, isFromAbove: false, across: 0, focus };
    }
    const { distance } = this.orbit;
    const far = Math.max(FAR, 1.6 * this.map.size + 1.3 * distance);
    this.look(this.orbit.pose(), width / height, Math.max(0.1, Math.min(2, 0.02 * distance)), far);
    return { camera: this.perspective, hidden: null, isFromAbove: false, across: 0, focus: null };
  }

  private placeAbove(width: number, height: number): Shown {
    const camera = this.orthographic;
    const scale = this.mapView.scale(width, height);
    const { x, z } = this.mapView;
    [camera.right, camera.top] = [(scale * width) / 2, (scale * height) / 2];
    [camera.left, camera.bottom] = [-camera.right, -camera.top];
    [camera.near, camera.far] = [1, 2 * HIGH];
    this.put(camera, { x, y: HIGH, z, yaw: 0, pitch: 90 }, 0);
    this.shared.pixel.value = (scale * height) / this.shared.viewport.value.y;
    return { camera, hidden: null, isFromAbove: true, across: scale * Math.min(width, height), focus: null };
  }

  // across: degrees, beyond which nothing is shown however wide the picture is. tall: likewise up and down, unless the
  // picture is narrow.
  private look(pose: Pose, aspect: number, near: number, far: number, across?: number, tall = 180): void {
    const camera = this.perspective;
    const wide = Math.tan(radians((across ?? ACROSS) / 2)) / Math.max(16 / 9, across ? aspect : 0);
    const most = Math.min(wide, Math.tan(radians(tall / 2)));
    const up = Math.max(most, Math.tan(radians(NARROWEST / 2)) / aspect);
    camera.fov = (360 / Math.PI) * Math.atan(up);
    [camera.aspect, camera.near, camera.far] = [aspect, near, 1.05 * far];
    this.put(camera, pose, far);
    this.shared.pixel.value = (2 * up) / this.shared.viewport.value.y;
  }

  private put(camera: PerspectiveCamera | OrthographicCamera, pose: Pose, far: number): void {
    camera.position.set(pose.x, pose.y, -pose.z);
    camera.rotation.set(-radians(pose.pitch), -radians(pose.yaw), 0);
    camera.updateMatrixWorld();
    camera.updateProjectionMatrix();
    this.shared.eye.value.set(pose.x, pose.y, pose.z);
    this.shared.far.value = far;
    writeToPlace(this.shared.toPlace.value, camera);
  }
}

// From a place on the screen to one in the game's frame.
function writeToPlace(matrix: Matrix4, camera: Camera): void {
  matrix.copy(camera.matrixWorld).multiply(camera.projectionMatrixInverse);
  for (let column = 0; column < 4; column++) matrix.elements[4 * column + 2] *= -1;
}
