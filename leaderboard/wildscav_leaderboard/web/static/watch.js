// Asks for the replay until it is rendered, says how far it is, and then shows it in the viewer.

const frame = document.querySelector("iframe[data-viewer]");
const status = document.querySelector("#replay-status");
const PAUSE = 1000; // ms between two questions

async function ask() {
  const answer = await fetch(frame.dataset.progress).catch(() => null);
  const progress = answer ? await answer.json() : { state: "waiting", detail: "The connection is lost; trying again …" };
  status.textContent = progress.detail || "The viewer is loading …";
  if (progress.state === "ready") {
    frame.addEventListener("load", () => (status.textContent = ""), { once: true });
    frame.src = frame.dataset.viewer;
  } else if (progress.state !== "failed") {
    setTimeout(ask, PAUSE);
  }
}

ask();
