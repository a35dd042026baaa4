import { expect, test } from "vitest";
import { MapView } from "../src/view/map_view";

test("the whole map is seen at first", () => {
  expect(new MapView(100).scale(400, 200)).toBeCloseTo(0.53);
});

test("zooming keeps the place under the pointer", () => {
  const view = new MapView(100);
  const at = (x: number, y: number) => {
    const scale = view.scale(400, 400);
    return [view.x + (x - 200) * scale, view.z - (y - 200) * scale];
  };
  const before = at(320, 60);
  view.zoom(2, 320, 60, 400, 400);
  expect(at(320, 60)[0]).toBeCloseTo(before[0]);
  expect(at(320, 60)[1]).toBeCloseTo(before[1]);
});

test("dragging moves the map with the pointer, as far as its edge", () => {
  const view = new MapView(100);
  view.drag(40, 20, 400, 400);
  expect([view.x, view.z]).toEqual([-40 * view.scale(400, 400), 20 * view.scale(400, 400)]);
  view.drag(-1e6, 0, 400, 400);
  expect(view.x).toBe(50);
});
