// A match on a map from above, for browsers without WebGL 2. The map is drawn once, what moves each time.

import type { Course } from "../data/course";
import type { GameMap } from "../data/map";
import { type Stage, TRAIL } from "../stage";
import { Input } from "../view/gestures";
import { MapView } from "../view/map_view";
import { momentOf } from "../view/moment";
import { createWays } from "../view/ways";
import { type Canvas, drawAgents, drawBoxes, drawShots, drawTarget, drawWays, drawZone } from "./overlay";
import { drawMap } from "./picture";

const BEYOND = "#6f8a5c"; // what surrounds the map
const PACE = 400; // CSS pixels in a second that held keys move the map

export function createFlatStage(canvas: HTMLCanvasElement, map: GameMap, course: Course): Stage {
  const context = canvas.getContext("2d") as CanvasRenderingContext2D;
  let picture = drawMap(map);
  let isNew = false;
  map.whole.then(() => {
    picture = drawMap(map);
    isNew = true;
  });
  const view = new MapView(map.size);
  const size = { width: 1, height: 1, ratio: 1 };
  const input = new Input(
    canvas,
    {
      drag: (right, down) => view.drag(right, down, size.width, size.height),
      zoom: (factor, x, y) => view.zoom(factor, x, y, size.width, size.height),
    },
    () => true,
  );
  const waysIn = createWays(course);
  let before = performance.now();
  const move = () => {
    const seconds = Math.min(0.1, (performance.now() - before) / 1000);
    before = performance.now();
    const [right, ahead] = input.heading();
    view.drag(-PACE * right * seconds, PACE * ahead * seconds, size.width, size.height);
  };
  // Begin a picture: from here on lengths are metres.
  const begin = (): Canvas => {
    const { width, height, ratio } = size;
    const pixel = view.scale(width, height);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = BEYOND;
    context.fillRect(0, 0, width, height);
    context.translate(width / 2, height / 2);
    context.scale(1 / pixel, -1 / pixel);
    context.translate(-view.x, -view.z);
    return { context, pixel };
  };
  const drawPicture = () => {
    const [west, south] = map.ground.corner;
    context.save();
    context.translate(west, south + map.size);
    context.scale(1, -1);
    context.imageSmoothingQuality = "high";
    context.drawImage(picture, 0, 0, map.size, map.size);
    context.restore();
  };
  const stage: Stage = {
    kinds: ["above"],
    view: { kind: "above", seat: 0 },
    get moving() {
      return input.isHeld || isNew;
    },
    trail: TRAIL,
    get camera() {
      return { above: view.place };
    },
    set camera({ above }) {
      view.place = above;
    },
    draw: (frame) => {
      isNew = false;
      move();
      const seen = begin();
      drawPicture();
      drawZone(seen, course, frame, map.size);
      drawTarget(seen, course);
      drawBoxes(seen, course, frame);
      drawWays(seen, course, waysIn(frame, stage.trail ?? 0));
      drawShots(seen, course, frame);
      drawAgents(seen, course, frame, momentOf(course, frame).flashes);
    },
    zoom: (factor) => view.zoom(factor, size.width / 2, size.height / 2, size.width, size.height),
    resize: (width, height, pixelRatio) => {
      Object.assign(size, { width, height, ratio: pixelRatio });
      canvas.width = Math.round(width * pixelRatio);
      canvas.height = Math.round(height * pixelRatio);
    },
    dispose: () => input.dispose(),
  };
  return stage;
}
