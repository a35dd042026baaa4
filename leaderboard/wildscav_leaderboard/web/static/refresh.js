// Loads a page again while something on it is going to change, unless somebody is typing or reading elsewhere.

const seconds = Number(document.querySelector("main").dataset.refresh);
if (seconds > 0) {
  setInterval(() => {
    if (document.visibilityState === "visible" && !document.querySelector("input:focus, select:focus, textarea:focus")) {
      location.reload();
    }
  }, 1000 * seconds);
}
