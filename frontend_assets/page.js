// What viser's page cannot do by itself: copy a link, look back by a click on the timeline or a plot, choose a grasp by
// its row, and say why it stands still.
"use strict";

let visitor = ""; // this page's key, as the server has told it

const banner = document.createElement("div");
banner.setAttribute("role", "alert");
banner.style.cssText = "position:fixed;top:12px;left:50%;transform:translateX(-50%);z-index:10000;max-width:80vw;" +
  "padding:10px 16px;border-radius:6px;background:#c92a2a;color:#fff;font:14px system-ui,sans-serif;display:none";

function say(text) {
  if (!banner.isConnected) document.body.append(banner);
  if (banner.textContent !== text) banner.textContent = text;
  banner.style.display = text ? "block" : "none";
}

let refusal = "";
function refuse(text) {
  say(refusal = text);
  setTimeout(() => { if (refusal === text) say(refusal = ""); }, 6000);
}

const LOST = "The server does not answer: it has ended, or the network is down. " +
  "This page goes on by itself as soon as it is there again.";

async function whyNotConnected(notServed) {
  try {
    const answer = await fetch("/api/v1/health", { signal: AbortSignal.timeout(3000) });
    const health = await answer.json();
    if (!answer.ok) return health.error;
    const { viewers, most_viewers: most } = health;
    const open = viewers === 1 ? "One browser is open" : `${viewers} browsers are open`;
    return notServed && viewers >= most ? `${open}, and more are not served: close one. ` +
      "This page goes on by itself then." : "";
  } catch {
    return LOST;
  }
}

let silent_s = 0;
async function watch() {
  const seat = document.querySelector("[data-visitor]");
  const frozen = seat?.closest('[style*="pointer-events: none"]'); // so viser shows what it last knew
  if (seat && !frozen && seat.dataset.visitor !== visitor) {
    visitor = seat.dataset.visitor;
    document.cookie = `grasping_visitor=${visitor}; path=/; samesite=strict`;
  }
  silent_s = seat && !frozen ? 0 : silent_s + 1;
  say(silent_s < 3 ? refusal : await whyNotConnected(frozen || !visitor));
  setTimeout(watch, 1000);
}
watch();

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

async function lookBack({ begin, end, box }, clientX) {
  const share = Math.min(1, Math.max(0, (clientX - box.left) / box.width));
  const answer = await fetch("/api/v1/session/commands", {
    method: "POST",
    headers: { "Content-Type": "application/json", "X-Visitor": visitor },
    body: JSON.stringify({ kind: "look_back", t_s: begin + share * (end - begin) }),
  });
  if (answer.status === 409) refuse((await answer.json()).error);
}

document.addEventListener("click", (event) => {
  const link = event.target.closest("a[data-copy]");
  if (link) {
    event.preventDefault();
    copyLink(link);
  }
  const row = event.target.closest("[data-grasp]");
  if (row) chooseGrasp(row.dataset.grasp);
});
document.addEventListener("keydown", (event) => {
  const row = event.target.closest?.("[data-grasp]");
  if (row && event.key === "Enter") chooseGrasp(row.dataset.grasp);
});

// As if the number had been typed into the box of the same panel.
function chooseGrasp(number) {
  const label = [...document.querySelectorAll("label")].find((one) => one.textContent.trim() === "Grasp no.");
  const box = label && document.getElementById(label.htmlFor);
  if (!box) return;
  Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value").set.call(box, number);
  box.dispatchEvent(new Event("input", { bubbles: true }));
}

// What is dragged along is drawn anew meanwhile, so its place is kept, not the element.
let dragged = null;
document.addEventListener("pointerdown", (event) => {
  const strip = event.target.closest("[data-strip]");
  if (!strip) return;
  const [begin, end] = strip.dataset.strip.split(" ").map(Number);
  dragged = { begin, end, box: strip.getBoundingClientRect() };
  lookBack(dragged, event.clientX);
});
let last = 0;
document.addEventListener("pointermove", (event) => {
  if (dragged && event.timeStamp - last > 60) {
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
