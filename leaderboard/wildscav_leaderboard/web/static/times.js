// Whoever cannot point at a time sees it exactly by a tap, and as before by another one.
"use strict";

document.addEventListener("click", (event) => {
  const time = event.target instanceof Element ? event.target.closest("time") : null;
  if (time === null || !time.title) return;
  [time.textContent, time.title] = [time.title, time.textContent];
});
