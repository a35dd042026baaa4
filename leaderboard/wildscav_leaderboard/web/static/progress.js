// Asks for a file until it is rendered, and tells how far it is meanwhile.

const PAUSE = 1000; // ms between two questions

async function progressOf(address) {
  const answer = await fetch(address).catch(() => null);
  if (!answer) return { state: "waiting", detail: "The connection is lost; trying again …" };
  if (answer.headers.get("content-type").startsWith("image/")) return { state: "ready" };
  return answer.json();
}

// Returns whether it is ready; not if it cannot be rendered, or may not be seen.
export async function untilReady(address, tell) {
  for (;;) {
    const { state, detail, error } = await progressOf(address);
    if (state === "ready") return true;
    tell(error ?? detail);
    if (error || state === "failed") return false;
    await new Promise((resolve) => setTimeout(resolve, PAUSE));
  }
}
