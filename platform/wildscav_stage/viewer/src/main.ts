// Fills every element with `data-match` with the player of a match. Its attributes:
// data-map, data-trails and data-notes are the URLs of its files, or data-embedded says that the page holds them;
// data-names has the names of seats as people read them, as JSON by number;
// data-live is the URL of the stream of a match that is being played;
// data-title is written over the picture;
// data-with says that the match is compared with that of the element before it: in an element with the class
// "player-pair", both have one time line, one clock and one kind of view.

import { createFlatStage } from "./flat";
import { show } from "./player/show";
import { createStage } from "./world";

for (const element of document.querySelectorAll<HTMLElement>("[data-match]")) {
  show(element, [createStage, createFlatStage]);
}
