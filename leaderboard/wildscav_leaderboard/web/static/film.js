// The video of a match: asks for it, says how far it is, and shows it once it is rendered. Its poster is shown at once.

import { untilReady } from "./progress.js";

const card = document.querySelector(".film");
const button = card.querySelector("a.button[rel]");
const status = card.querySelector("[role=status]");

async function showPoster() {
  if (card.querySelector("img") || !(await untilReady(card.dataset.poster, () => {})) || card.querySelector("video")) return;
  const poster = document.createElement("img");
  Object.assign(poster, { src: card.dataset.poster, alt: "A moment of the match", width: 1280, height: 720 });
  card.querySelector(".screen")?.replaceWith(poster);
}

function showVideo() {
  const video = document.createElement("video");
  Object.assign(video, { controls: true, autoplay: true, muted: true, playsInline: true, poster: card.dataset.poster, src: card.dataset.file });
  card.querySelector(".screen, img").replaceWith(video);
  button.href = card.dataset.file;
  button.download = card.dataset.name;
  button.className = "button quiet";
  button.textContent = "Download the video";
  status.textContent = "";
}

async function ask() {
  button.removeEventListener("click", asked);
  button.addEventListener("click", stay);
  button.setAttribute("aria-disabled", "true");
  if (await untilReady(card.dataset.progress, (text) => (status.textContent = text))) showVideo();
  button.removeEventListener("click", stay);
  button.removeAttribute("aria-disabled");
}

function stay(event) {
  event.preventDefault();
}

function asked(event) {
  event.preventDefault();
  ask();
}

if (button) {
  button.addEventListener("click", asked);
  showPoster();
  if ("asked" in card.dataset) ask();
}
