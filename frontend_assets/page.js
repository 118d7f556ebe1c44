// What viser's page cannot do by itself: copy a link, and look back by a click on the timeline.
"use strict";

async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = document.createElement("textarea"); // where the page is not served securely
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
}

async function copyLink(link) {
  await copy(link.href);
  const label = link.textContent;
  link.textContent = "Copied";
  setTimeout(() => { link.textContent = label; }, 1500);
}

function lookBack(strip, clientX) {
  const [begin, end] = strip.dataset.strip.split(" ").map(Number);
  const box = strip.getBoundingClientRect();
  const share = Math.min(1, Math.max(0, (clientX - box.left) / box.width));
  fetch("/api/v1/session/commands", {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify({ kind: "look_back", t_s: begin + share * (end - begin) }),
  });
}

document.addEventListener("click", (event) => {
  const link = event.target.closest("a[data-copy]");
  if (link) {
    event.preventDefault();
    copyLink(link);
  }
});

let dragged = null;
document.addEventListener("pointerdown", (event) => {
  dragged = event.target.closest("[data-strip]");
  if (dragged) lookBack(dragged, event.clientX);
});
let last = 0;
document.addEventListener("pointermove", (event) => {
  if (dragged && dragged.isConnected && event.timeStamp - last > 60) {
    last = event.timeStamp;
    lookBack(dragged, event.clientX);
  }
});
document.addEventListener("pointerup", () => { dragged = null; });

// The arrows step through time: T and B do so for viser, which would turn the camera with arrows.
const TICKS = { ArrowRight: ["t", "KeyT"], ArrowLeft: ["b", "KeyB"] };
const OWN_ARROWS = "input, textarea, select, [contenteditable], [role=slider], [role=tab], [role=dialog]";
for (const kind of ["keydown", "keyup"]) {
  window.addEventListener(kind, (event) => {
    const tick = TICKS[event.key];
    if (!tick || event.ctrlKey || event.altKey || event.metaKey || event.shiftKey) return;
    if (event.target.closest?.(OWN_ARROWS)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    const [key, code] = tick;
    event.target.dispatchEvent(new KeyboardEvent(kind, { key, code, bubbles: true, cancelable: true }));
  }, true);
}
