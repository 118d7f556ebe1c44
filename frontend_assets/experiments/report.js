// Report: tables and Plotly's figures of the rows there are, made beside the server when asked for.
import { ask, el } from "./dom.js";

let plotly = null;
function loadPlotly() {
  plotly ??= new Promise((resolve, reject) => {
    document.head.append(el("script", { src: "/experiments/plotly.js", onload: () => resolve(window.Plotly), onerror: () => reject(new Error("Plotly's script could not be loaded.")) }));
  });
  return plotly;
}

export function report(run) {
  const body = el("div", { class: "report" }), line = el("span", { class: "quiet" });
  const judge = el("select", { "aria-label": "judge" }, ["strict", "authors"].map((name) => el("option", { value: name, selected: name === run.judge }, `${name} rule`)));
  const make = el("button", { type: "button", onclick: () => draw() }, "Make it again");
  const node = el("div", {}, el("div", { class: "filters" }, judge, make, line), body);
  judge.addEventListener("change", () => draw());
  let latest = run, made = null;

  async function draw() {
    make.disabled = judge.disabled = true;
    line.textContent = "Working it out; some seconds...";
    try {
      const [found, Plotly] = await Promise.all([ask(`/runs/${encodeURIComponent(run.name)}/report?judge=${judge.value}`), loadPlotly()]);
      made = found;
      await show(body, found, Plotly);
      told();
    } catch (error) {
      line.textContent = error.message;
    }
    make.disabled = judge.disabled = false;
  }
  function told() {
    if (made) line.textContent = `Of ${made.rows} trials` + (latest.done > made.rows ? `; ${latest.done - made.rows} have come since.` : ".");
  }
  document.addEventListener("themechange", async () => { if (made && node.isConnected) await show(body, made, await loadPlotly()); });
  if (run.done) draw(); else line.textContent = "There are no trials to report yet.";
  return { node, update(now) { if (!latest.done && now.done) draw(); latest = now; told(); } };
}

async function show(body, found, Plotly) {
  const plain = found.tables.filter((table) => !table.folded && !table.papers).map(tableNode);
  const papers = found.tables.filter((table) => table.papers).map(tableNode);
  const folded = found.tables.filter((table) => table.folded).map((table) => el("details", {}, el("summary", {}, table.title), tableNode(table)));
  const plots = found.figures.map(() => el("div", { class: "plot" }));
  body.replaceChildren(el("ul", {}, found.facts.map((fact) => el("li", {}, fact.replaceAll("`", "")))), ...papers,
    ...plots.flatMap((plot, i) => [el("h3", {}, found.figures[i].layout.title?.text ?? ""), plot]), ...plain, ...folded);
  for (const [i, figure] of found.figures.entries()) await Plotly.newPlot(plots[i], inked(figure.data), themed(figure.layout), { responsive: true, displaylogo: false });
}

function tableNode(table) {
  return el("div", { class: "wide" }, el("table", {}, el("caption", {}, table.title),
    el("thead", {}, el("tr", {}, table.header.map((cell) => el("th", {}, cell)))),
    el("tbody", {}, table.lines.map((line) => el("tr", {}, line.map((cell) => el("td", {}, cell)))))),
  table.note ? el("p", { class: "quiet small" }, table.note) : null);
}

function themed(layout) {
  const style = getComputedStyle(document.documentElement), color = (name) => style.getPropertyValue(name).trim();
  const out = { ...layout, title: undefined, height: 400, margin: { l: 55, r: 20, t: 35, b: 50 }, paper_bgcolor: "transparent", plot_bgcolor: "transparent", font: { color: color("--text") } };
  for (const name of Object.keys(layout).filter((key) => /^[xy]axis\d*$/.test(key))) out[name] = { ...layout[name], gridcolor: color("--line"), zerolinecolor: color("--line") };
  if (innerWidth < 720) out.legend = { orientation: "h", y: -0.25 };
  return out;
}

// Marks that are black on paper are of the text's colour here.
function inked(traces) {
  const ink = getComputedStyle(document.documentElement).getPropertyValue("--text").trim();
  return traces.map((trace) => (trace.marker?.line?.color === "black" ? { ...trace, marker: { ...trace.marker, line: { ...trace.marker.line, color: ink } } } : trace));
}
