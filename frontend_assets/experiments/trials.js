// Trials: the rows that fit a filter, page by page; each leads to its replay in the scene.
import { ask, el, place, seconds, words } from "./dom.js";

const PAGE = 50;
const FILTERS = ["robot", "task", "object", "method", "outcome", "reason"];
const REPLAYS = {
  elsewhere: "",
  running: "The scene plays this trial now.",
  same: "Replayed in the scene: outcome and fingerprint are those of the row.",
  different: "Replayed in the scene, but it came out otherwise than the row says.",
};

export function trials(first, choices) {
  const selects = {}, head = el("div", { class: "filters" }), body = el("tbody"), pager = el("div", { class: "pager" });
  const node = el("div", {}, head, el("div", { class: "wide" }, el("table", { class: "trials" },
    el("thead", {}, el("tr", {}, ["Outcome", "Scene", "Robot", "Task", "Object", "Method", "No."].map((title) => el("th", {}, title)),
      ["Approach at", "Lifted at", "Cycles"].map((title) => el("th", { class: "less" }, title)))), body)), pager);
  let offset = 0, asked = "", open = null, openDetail = null, latest = first;

  const filter = () => Object.fromEntries(FILTERS.map((name) => [name, place.read()[name] ?? ""]).filter(([, value]) => value));
  const titles = (kind) => Object.fromEntries((choices[kind + "s"] ?? []).map((choice) => [choice.name, choice.title]));

  function drawFilters(run) {
    const options = {
      robot: run.settings.robots, task: run.settings.tasks, object: run.settings.objects, method: run.settings.methods,
      outcome: ["success", "failure"], reason: Object.keys(run.reasons),
    };
    for (const name of FILTERS) {
      const known = titles(name), names = [...options[name]], chosen = filter()[name] ?? "";
      if (chosen && !names.includes(chosen)) names.push(chosen);
      const made = [el("option", { value: "" }, "any"), ...names.map((value) => el("option", { value }, { success: "grasped", failure: "failed" }[value] ?? known[value] ?? words(value)))];
      selects[name] ??= el("select", { "aria-label": name, onchange: () => { offset = 0; place.go({ run: run.name, tab: "trials", ...chosenNow() }); } });
      if (selects[name].options.length !== made.length) selects[name].replaceChildren(...made);
      if (document.activeElement !== selects[name]) selects[name].value = chosen;
    }
    if (!head.childElementCount) {
      head.append(...FILTERS.map((name) => el("label", {}, name, selects[name])),
        el("button", { type: "button", onclick: () => { offset = 0; place.go({ run: run.name, tab: "trials" }); } }, "Show all"));
    }
  }
  const chosenNow = () => Object.fromEntries(FILTERS.map((name) => [name, selects[name].value]));

  async function update(run) {
    latest = run;
    drawFilters(run);
    const query = new URLSearchParams({ ...filter(), judge: run.judge, offset, limit: PAGE }).toString();
    const key = `${query} ${run.done}`;
    if (key !== asked) {
      const page = await ask(`/runs/${encodeURIComponent(run.name)}/rows?${query}`);
      asked = key;
      drawRows(run, page);
    }
    if (openDetail) await openDetail();
  }

  function drawRows(run, page) {
    openDetail = null;
    const rows = page.rows.flatMap((row) => rowNodes(run, row));
    body.replaceChildren(...(rows.length ? rows : [el("tr", {}, el("td", { colspan: 10, class: "quiet" }, "No trial fits this filter yet."))]));
    const last = Math.min(page.offset + PAGE, page.total);
    const turn = (title, by, possible) => el("button", { type: "button", disabled: !possible, onclick: () => { offset = Math.max(0, offset + by); update(latest); } }, title);
    pager.replaceChildren(turn("Before", -PAGE, page.offset > 0), el("span", {}, page.total ? `${page.offset + 1} to ${last} of ${page.total}` : "none"), turn("After", PAGE, last < page.total));
  }

  function rowNodes(run, row) {
    const key = [row.robot, row.task, row.object, row.method, row.index].join("/");
    const good = run.judge === "strict" ? row.strict : row.authors;
    const play = row.link
      ? el("a", { class: "play", href: row.link, target: "scene", title: "Open exactly this trial in the scene", onclick: (event) => { event.stopPropagation(); if (open !== key) toggle(); } }, "Replay")
      : el("span", { class: "quiet", title: "The row says why" }, "-");
    const detail = el("td", { class: "detail", colspan: 10 });
    const below = el("tr", { hidden: true }, detail);
    const line = el("tr", { class: "trial", tabindex: 0, onclick: () => toggle(), onkeydown: (event) => { if (event.key === "Enter" && event.target === line) toggle(); } },
      el("td", {}, el("span", { class: good ? "yes" : "no" }, good ? "grasped" : words(row.reason ?? "failed"))),
      el("td", {}, play), el("td", {}, row.robot), el("td", {}, words(row.task)), el("td", {}, words(row.object)), el("td", {}, row.method), el("td", {}, String(row.index)),
      el("td", { class: "less" }, seconds(row.approach_start_s)), el("td", { class: "less" }, seconds(row.lift_end_s)), el("td", { class: "less" }, String(row.cycles)));

    async function draw() {
      const state = await ask(`/runs/${encodeURIComponent(run.name)}/rows/${key}`);
      const facts = {
        Key: key, "Rules": `strict: ${row.strict ? "grasped" : words(row.reason ?? "failed")}; authors: ${row.authors ? "grasped" : "failed"}`, Seed: row.seed,
        "Belt": row.distance_m === null ? "-" : `${(100 * row.distance_m).toFixed(1)} cm from the base, ${(100 * row.speed_mps).toFixed(1)} cm/s`,
        "Cycles": row.cycle_mean_ms === null ? "-" : `${row.cycles}, ${row.cycle_mean_ms.toFixed(1)} ms each, 95 % within ${row.cycle_p95_ms.toFixed(1)} ms`,
        Fingerprint: row.fingerprint || "none", Code: row.code + (state.other_code ? " (other than this server's: a replay may come out otherwise)" : ""),
        "Run": `${row.finished}, ${row.machine}`,
      };
      const verdict = state.no_link || REPLAYS[state.replay];
      detail.replaceChildren(el("div", {}, row.detail || "Lifted and held by the hand alone."),
        verdict ? el("p", { class: state.replay === "same" ? "yes" : state.replay === "different" ? "no" : "quiet" }, verdict) : "",
        el("dl", { class: "facts" }, Object.entries(facts).flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, String(value))])));
    }
    function toggle() {
      const opening = open !== key;
      for (const other of body.querySelectorAll("tr.open")) { other.classList.remove("open"); other.nextSibling.hidden = true; }
      open = opening ? key : null;
      openDetail = opening ? draw : null;
      below.hidden = !opening;
      line.classList.toggle("open", opening);
      if (opening) draw();
    }
    if (open === key) { below.hidden = false; line.classList.add("open"); openDetail = draw; }
    return [line, below];
  }
  return { node, update };
}
