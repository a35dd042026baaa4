// Asks for the replay until it is rendered, says how far it is, and then shows it in the viewer.

import { untilReady } from "./progress.js";

const frame = document.querySelector("iframe[data-viewer]");
const status = document.querySelector("#replay-status");

if (await untilReady(frame.dataset.progress, (text) => (status.textContent = text))) {
  status.textContent = "The viewer is loading …";
  frame.addEventListener("load", () => (status.textContent = ""), { once: true });
  frame.src = frame.dataset.viewer;
}
