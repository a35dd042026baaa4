// Fills every element with `data-match` with the player of a match. Its attributes:
// data-map and data-trails are the URLs of the two files, or data-embedded says that the page holds them;
// data-names has the names of seats as people read them, as JSON by number;
// data-live is the URL of the stream of a match that is being played.

import { createFlatStage } from "./flat";
import { show } from "./player/show";
import { createStage } from "./world";

for (const element of document.querySelectorAll<HTMLElement>("[data-match]")) {
  show(element, [createStage, createFlatStage]);
}
