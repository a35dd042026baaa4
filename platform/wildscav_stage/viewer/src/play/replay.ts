// The links to the match that was played, for everybody who has a link of the table.

import { make } from "../player/dom";
import { find } from "./dom";
import type { Over } from "./messages";

export function showReplay({ match: { number, record } }: Over): void {
  const href = `${location.pathname}/matches/${number}`;
  const links = [make("a", { href, target: "_blank" }, "Watch it in 3D")];
  if (record) links.push(make("a", { href: `${href}/record`, download: record }, "Download the record"));
  find("replay").replaceChildren(...links);
  find("replay").hidden = false;
}
