// When a page fetches a map.

import { expect, test, vi } from "vitest";
import { withMap } from "../src/play/scene";

test("a map is fetched once, and again when a match is on another one", () => {
  const fetched: string[] = [];
  const fetch = (address: string) => new Promise(() => fetched.push(address));
  vi.stubGlobal("location", { pathname: "/play/x" });
  vi.stubGlobal("fetch", fetch);
  for (const key of ["a", "a", "b"])
    withMap(
      key,
      () => {},
      () => {},
    );
  expect(fetched).toEqual(["/play/x/map?key=a", "/play/x/map?key=b"]);
});
