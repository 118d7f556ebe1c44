// New run: a form over the grid's own words; what it would come to is said before it can be started.
import { ask, el, place } from "./dom.js";

const LISTS = ["robots", "tasks", "objects", "methods"];
const WAIT_MS = 350;

export function newRun(choices, names, refresh) {
  const boxes = Object.fromEntries(LISTS.map((list) => [list, choices[list].map((choice) => ({ name: choice.name, title: choice.title,
    input: el("input", { type: "checkbox", checked: choice.usual, onchange: () => later() }) }))]));
  const text = (value, more = {}) => el("input", { type: "text", value, oninput: () => later(), ...more });
  const number = (value, least, more = {}) => el("input", { type: "number", value, min: least, step: 1, oninput: () => later(), ...more });
  const select = (options) => el("select", { onchange: () => later() }, options.map((name) => el("option", { value: name }, name)));
  const fields = {
    name: text(freeName(names), { maxlength: 64, size: 24 }), trials: number(10, 1), first_seed: number(0, 0), workers: number(choices.cores, 1),
    profile: select(choices.profiles), think: select(choices.thinks), judge: select(choices.judges),
  };
  fields.profile.value = "paper";
  const set = el("textarea", { rows: 2, cols: 44, placeholder: "sensing.position_noise_std_m=0.002", oninput: () => later() });
  const estimate = el("p", { class: "estimate", role: "status" }), source = el("p", { class: "quiet small" });
  const start = el("button", { class: "primary", type: "submit", disabled: true }, "Start");
  let waiting = 0, asked = 0;

  const whole = (input) => (input.value === "" ? undefined : Number(input.value));
  function body() {
    return {
      ...Object.fromEntries(LISTS.map((list) => [list, boxes[list].filter((box) => box.input.checked).map((box) => box.name)])),
      name: fields.name.value.trim(), trials: whole(fields.trials), first_seed: whole(fields.first_seed), workers: whole(fields.workers),
      profile: fields.profile.value, think: fields.think.value, judge: fields.judge.value,
      set: set.value.split("\n").map((line) => line.trim()).filter(Boolean),
    };
  }
  function later() {
    start.disabled = true;
    clearTimeout(waiting);
    waiting = setTimeout(tell, WAIT_MS);
  }
  function say(words, more, bad) {
    estimate.textContent = words;
    estimate.classList.toggle("bad", bad);
    source.textContent = more;
  }
  async function tell() {
    const number = ++asked;
    try {
      const found = await ask("/runs?dry_run=true", body());
      if (number !== asked) return;
      const done = found.done ? `, ${found.done} of them done` : "";
      say(`${found.trials} trials${done}: ${found.words} on ${found.workers} ${found.workers === 1 ? "worker" : "workers"}.`, `Estimated: ${found.source}.`, false);
      start.textContent = found.done ? "Go on" : "Start";
      start.disabled = found.done >= found.trials;
    } catch (error) {
      if (number === asked) say(error.message.replaceAll("body.", ""), "", true);
    }
  }
  async function submit(event) {
    event.preventDefault();
    start.disabled = true;
    try {
      await ask("/runs", body());
      place.go({ run: body().name });
      refresh();
    } catch (error) {
      say(error.message, "", true);
    }
  }
  const group = (list) => el("fieldset", {}, el("legend", {}, list), el("div", { class: "checks" }, boxes[list].map((box) => el("label", {}, box.input, box.title))));
  const field = (title, input) => el("label", {}, title, input);
  const node = el("form", { class: "form", onsubmit: submit }, el("h2", {}, "New run"),
    el("p", { class: "quiet" }, "Every method runs the same trials. The run goes on beside the scene, ends with the server, and can always be gone on with."),
    el("div", { class: "row" }, field("Name (a folder among the runs)", fields.name), field("Trials of each cell and object", fields.trials), field("First seed", fields.first_seed), field("Workers", fields.workers)),
    ["robots", "methods", "tasks", "objects"].map(group),
    el("div", { class: "row" }, field("Joint speeds", fields.profile), field("Thinking is charged", fields.think), field("Shown successes", fields.judge), field("Conditions, one path=value a line", set)),
    el("div", { class: "doing" }, estimate, source, el("div", { class: "row" }, start, el("button", { type: "button", onclick: () => place.go({}) }, "Cancel"))));
  tell();
  return { node };
}

function freeName(names) {
  let i = 1;
  while (names.includes(`run${i}`)) i += 1;
  return `run${i}`;
}
