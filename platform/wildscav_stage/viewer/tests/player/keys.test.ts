import { expect, test } from "vitest";
import type { Actions } from "../../src/player/controls";
import { actionOf } from "../../src/player/keys";

// What a key does, as the name of an action and what it is told.
function pressed(key: string): [string, ...unknown[]] | undefined {
  let done: [string, ...unknown[]] | undefined;
  const actions = new Proxy({} as Actions, {
    get:
      (_, name: string) =>
      (...told: unknown[]) => {
        done = [name, ...told];
      },
  });
  actionOf(key)?.(actions);
  return done;
}

test.each<[string, [string, ...unknown[]] | undefined]>([
  [" ", ["toggle"]],
  ["ArrowLeft", ["leap", -5]],
  ["ArrowRight", ["leap", 5]],
  [",", ["step", -1]],
  [".", ["step", 1]],
  ["V", ["nextView"]],
  ["7", ["follow", 7]],
  ["0", ["follow", 0]],
  ["f", ["toggleFullscreen"]],
  ["q", undefined],
  ["Tab", undefined],
])("the key %o", (key, action) => {
  expect(pressed(key)).toEqual(action);
});
