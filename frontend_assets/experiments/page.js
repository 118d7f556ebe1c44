// The page: the list of runs on the left, one of them on the right, both kept up to date.
import { ask, bar, duration, el, percent, place } from "./dom.js";
import { newRun } from "./new_run.js";
import { overview } from "./overview.js";
import { report } from "./report.js";
import { settings } from "./settings.js";
import { trials } from "./trials.js";

const EVERY_MS = 2000;
const TABS = { overview: ["Overview", overview], trials: ["Trials", trials], report: ["Report", report], settings: ["Settings", settings] };
const STATES = { running: "running", stopped: "stopped", complete: "complete", unreadable: "cannot be read", foreign: "not a run" };
const main = document.getElementById("main");

let choices = null; // what a grid may say, with titles
let shown = null; // what the right side shows: {key, update}
let runs = [];

function trouble(error) {
  const box = document.getElementById("trouble");
  box.hidden = !error;
  box.textContent = error ? error.message : "";
}

async function refresh() {
  try {
    choices ??= await ask("/grid");
    const listed = await ask("/runs");
    runs = listed.runs;
    list(listed);
    await show();
    trouble(null);
  } catch (error) {
    trouble(error);
  }
}

// The run in the address; without one, what runs, or else the first that can be read.
function chosen(at) {
  return at.run ?? runs.find((run) => run.state === "running")?.name ?? runs.find((run) => run.trials > 0)?.name;
}

function list(listed) {
  const at = place.read(), here = at.new ? null : chosen(at);
  const items = listed.runs.map((run) => {
    const readable = run.trials > 0;
    const line = readable ? `${run.done} of ${run.trials}` : run.note.slice(0, 60);
    return el("li", {}, el("button", { class: "run", type: "button", "aria-current": String(run.name === here), onclick: () => place.go({ run: run.name }) },
      el("div", { class: "line" }, el("span", { class: "name" }, run.name), el("span", { class: `badge ${run.state}` }, run.stopping ? "stopping" : STATES[run.state])),
      el("div", { class: "line small quiet" }, el("span", {}, line), el("span", {}, readable && run.done ? percent(run.successes, run.done) : "")),
      readable ? bar(run.done / run.trials) : null));
  });
  document.getElementById("runs").replaceChildren(...items);
  const folder = document.getElementById("folder");
  folder.textContent = `Folder: ${listed.folder.split("/").pop()}`;
  folder.title = listed.folder;
}

async function show() {
  const at = place.read();
  if (at.new) return swap("new", () => newRun(choices, runs.map((run) => run.name), refresh));
  const name = chosen(at);
  if (!name) return swap("empty", nothing);
  const run = await ask(`/runs/${encodeURIComponent(name)}`);
  if (place.read().run !== at.run || place.read().new) return; // somebody has gone elsewhere meanwhile
  if (run.trials === 0) return swap(`unreadable ${name} ${run.note} ${run.state}`, () => unreadable(run));
  const tab = at.tab in TABS ? at.tab : "overview";
  swap(`${name} ${tab}`, () => one(run, tab));
  await shown.update(run);
}

function swap(key, make) {
  if (shown?.key === key) return;
  const made = make();
  shown = { key, update: made.update ?? (() => {}) };
  main.replaceChildren(made.node);
}

function nothing() {
  return { node: el("div", { class: "empty" },
    el("h2", {}, "No runs yet"),
    el("p", {}, "A run tries out methods on the same trials and keeps every outcome. Begin one here, or in a terminal:"),
    el("p", {}, el("code", {}, "python -m backend grid --out runs/first --trials 5")),
    el("p", {}, el("button", { class: "primary", type: "button", onclick: () => place.go({ new: "1" }) }, "New run"))) };
}

function unreadable(run) {
  const heading = run.state === "running" ? "It is starting" : run.state === "foreign" ? "This is not a run" : "This run cannot be read";
  return { node: el("div", {},
    el("h2", {}, run.name),
    el("div", { class: "note" }, el("b", {}, heading + ". "), run.note, run.last_words ? `\n${run.last_words}` : ""),
    el("p", { class: "quiet" }, "The other runs are not touched by this.")) };
}

function one(run, tab) {
  const badge = el("span", { class: "badge" }), acts = el("div", { class: "acts" }), figures = el("div", { class: "figures" });
  const progress = el("div"), note = el("div", { class: "note", hidden: true }), body = el("div");
  const tabs = el("div", { class: "tabs", role: "tablist" }, Object.entries(TABS).map(([name, [title]]) =>
    el("button", { type: "button", role: "tab", "aria-selected": String(name === tab), onclick: () => place.go({ run: run.name, tab: name }) }, title)));
  const content = TABS[tab][1](run, choices);
  body.append(content.node);
  let drawn = "";
  async function update(now) {
    const key = JSON.stringify(now);
    if (key !== drawn) {
      drawn = key;
      badge.className = `badge ${now.state}`;
      badge.textContent = now.stopping ? "finishing the trials under way" : STATES[now.state];
      figures.replaceChildren(...figuresOf(now));
      progress.replaceChildren(bar(now.done / now.trials));
      acts.replaceChildren(...actsOf(now));
      note.hidden = !(now.last_words || now.note);
      note.textContent = now.last_words || now.note;
    }
    await content.update?.(now);
  }
  return { update, node: el("div", {}, el("div", { class: "head" }, el("h2", {}, run.name), badge, acts), figures, progress, note, tabs, body) };
}

function figuresOf(run) {
  const figure = (value, what) => el("div", {}, el("b", {}, value), el("span", { class: "quiet small" }, what));
  const out = [figure(`${run.done} / ${run.trials}`, "trials"), figure(percent(run.successes, run.done), `grasped (${run.judge} rule)`)];
  if (run.errors) out.push(figure(String(run.errors), "errors"));
  if (run.state === "running") {
    out.push(figure(run.per_s === null ? "-" : `${run.per_s.toFixed(2)} / s`, "rate"));
    out.push(figure(run.left_s === null ? "-" : duration(run.left_s), "left"));
  }
  return out;
}

function actsOf(run) {
  const act = (title, path, primary, hint) => el("button", { type: "button", class: primary ? "primary" : null, title: hint, onclick: async (event) => {
    event.currentTarget.disabled = true;
    try {
      await ask(`/runs/${encodeURIComponent(run.name)}${path}`, {});
    } catch (error) {
      return trouble(error);
    }
    refresh();
  } }, title);
  if (run.own && run.stopping) return [act("End at once", "/stop", false, "Trials under way are dropped; rows are kept")];
  if (run.own) return [act("Stop", "/stop", false, "Trials under way are finished first; it can be gone on with")];
  if (run.state === "stopped") return [act("Go on", "/go-on", true, "Run the trials that are missing")];
  if (run.state === "running") return [el("span", { class: "quiet small" }, "Started outside this page: Ctrl-C there ends it.")];
  return [];
}

const themeButton = document.getElementById("theme");
function nameTheme() { themeButton.textContent = document.documentElement.dataset.theme === "dark" ? "Light" : "Dark"; }
themeButton.addEventListener("click", () => {
  const next = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
  document.documentElement.dataset.theme = next;
  localStorage.setItem("theme", next);
  nameTheme();
  document.dispatchEvent(new Event("themechange"));
});
nameTheme();
document.getElementById("new").addEventListener("click", () => place.go({ new: "1" }));
window.addEventListener("hashchange", refresh);
document.addEventListener("visibilitychange", () => { if (!document.hidden) refresh(); });

async function keepUp() {
  if (!document.hidden) await refresh();
  setTimeout(keepUp, EVERY_MS);
}
keepUp();
