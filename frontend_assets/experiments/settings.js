// Settings: what a run was begun with, and the command that does the same in a terminal.
import { el } from "./dom.js";

export function settings(run) {
  const shown = Object.entries(run.settings).filter(([, value]) => value !== null && !(Array.isArray(value) && !value.length));
  return { node: el("div", {},
    el("dl", { class: "facts" }, [...shown, ["judge", run.judge]].flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, Array.isArray(value) ? value.join(", ") : String(value))])),
    el("h3", {}, "In a terminal"),
    el("p", {}, el("code", {}, `python -m backend report runs/${run.name}`)),
    el("p", {}, el("code", {}, `python -m backend export runs/${run.name}`))) };
}
