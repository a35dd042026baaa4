// The links to the match that was played, for everybody who was told of its end.

import { make } from "../player/dom";
import { find } from "./dom";
import type { Over } from "./messages";

export function showReplay({ match: { secret, record } }: Over): void {
  const href = `../matches/${secret}`; // without the secret of the page, as people pass it on
  const links = [make("a", { href, target: "_blank" }, "Watch it in 3D")];
  if (record) links.push(make("a", { href: `${href}/record`, download: record }, "Download the record"));
  find("replay").replaceChildren(...links);
  find("replay").hidden = false;
}
