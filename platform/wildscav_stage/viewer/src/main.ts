// Fills every element with `data-match` with the player of a match. Its attributes:
// data-map and data-trails are the URLs of the two files, or data-embedded says that the page holds them;
// data-names has the names of seats as people read them, as JSON by number;
// data-live says that the match is being played: new samples are asked for until it is over;
// data-title is written over the picture;
// data-with says that the match is compared with that of the element before it: in an element with the class
// "player-pair", both have one time line, one clock and one kind of view.

import { createFlatStage } from "./flat";
import { show } from "./player/show";
import { createStage } from "./world";

for (const element of document.querySelectorAll<HTMLElement>("[data-match]")) {
  show(element, [createStage, createFlatStage]);
}
