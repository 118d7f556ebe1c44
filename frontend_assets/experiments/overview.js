// Overview: success by method, cell by cell, and why trials failed. A click leads to the trials themselves.
import { bar, el, percent, place, words } from "./dom.js";

export function overview(first, choices) {
  const node = el("div");
  let drawn = "";
  function update(run) {
    const key = JSON.stringify([run.cells, run.reasons]);
    if (key === drawn) return;
    drawn = key;
    node.replaceChildren(...(run.cells.length ? parts(run, choices) : [el("p", { class: "quiet" }, "The first trials are under way; their outcomes show here as they come.")]));
  }
  update(first);
  return { node, update };
}

const hits = (run, cell) => (run.judge === "strict" ? cell.strict : cell.authors);
const sum = (cells, of) => cells.reduce((total, cell) => total + of(cell), 0);

function parts(run, choices) {
  const titles = (kind) => Object.fromEntries(choices[kind].map((choice) => [choice.name, choice.title]));
  const methods = titles("methods"), robots = titles("robots"), tasks = titles("tasks");
  const out = [el("h3", {}, "Success by method"), el("div", { class: "methods" }, run.settings.methods.flatMap((method) => {
    const own = run.cells.filter((cell) => cell.method === method);
    const n = sum(own, (cell) => cell.n), good = sum(own, (cell) => hits(run, cell));
    return [el("span", {}, methods[method] ?? method), bar(n ? good / n : 0, true), el("span", {}, `${percent(good, n)} of ${n}`)];
  }))];
  for (const robot of run.settings.robots) {
    const own = run.cells.filter((cell) => cell.robot === robot);
    if (!own.length) continue;
    out.push(el("h3", {}, robots[robot] ?? robot), el("div", { class: "wide" }, el("table", { class: "cells" },
      el("thead", {}, el("tr", {}, el("th"), run.settings.tasks.map((task) => el("th", {}, tasks[task] ?? task)))),
      el("tbody", {}, run.settings.methods.map((method) => el("tr", {}, el("th", {}, methods[method] ?? method),
        run.settings.tasks.map((task) => el("td", {}, cellButton(run, own.find((cell) => cell.method === method && cell.task === task))))))))));
  }
  const reasons = Object.entries(run.reasons);
  if (reasons.length) {
    out.push(el("h3", {}, "Why trials failed (strict rule)"), el("div", { class: "chips" }, reasons.map(([reason, count]) =>
      el("button", { type: "button", onclick: () => place.go({ run: run.name, tab: "trials", reason }) }, `${words(reason)} ${count}`))));
  }
  return out;
}

function cellButton(run, cell) {
  if (!cell) return "";
  const share = hits(run, cell) / cell.n;
  const button = el("button", { type: "button", title: "Show the failed trials of this cell, or all where none failed", onclick: () =>
    place.go({ run: run.name, tab: "trials", robot: cell.robot, task: cell.task, method: cell.method, outcome: share < 1 ? "failure" : "" }) },
  percent(hits(run, cell), cell.n), el("small", {}, `${hits(run, cell)} of ${cell.n}`));
  button.style.background = `color-mix(in srgb, var(--good) ${Math.round(40 * share ** 2)}%, color-mix(in srgb, var(--bad) ${Math.round(60 * (1 - share))}%, var(--card)))`;
  return button;
}
