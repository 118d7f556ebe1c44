// Small pieces that every part of the page is built of; text from outside never becomes markup.

export function el(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return node;
}

export async function ask(path, body) {
  const options = body === undefined ? {} : {
    method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body),
  };
  let answer;
  try {
    answer = await fetch("/api/v1" + path, options);
  } catch {
    throw new Error("The server does not answer. Is it still running? This page goes on as soon as it is back.");
  }
  const content = await answer.json().catch(() => ({}));
  if (!answer.ok) throw new Error(content.error ?? `The server said ${answer.status}.`);
  return content;
}

export function bar(share, good = false) {
  const inner = el("i");
  inner.style.width = `${(100 * Math.min(1, share)).toFixed(1)}%`;
  return el("div", { class: good ? "bar good" : "bar" }, inner);
}

export const percent = (part, whole) => (whole ? `${((100 * part) / whole).toFixed(1)} %` : "-");
export const seconds = (value) => (value === null ? "-" : `${value.toFixed(1)} s`);
export const words = (name) => name.replaceAll("_", " ");

export function duration(s) {
  const minutes = Math.round(s / 60);
  if (minutes < 1) return "less than a minute";
  return minutes < 90 ? `${minutes} min` : `${Math.floor(minutes / 60)} h ${String(minutes % 60).padStart(2, "0")} min`;
}

// What is chosen stands in the address, so that it can be copied, reloaded and gone back from.
export const place = {
  read: () => Object.fromEntries(new URLSearchParams(location.hash.slice(1))),
  go(values) {
    const kept = Object.entries(values).filter(([, value]) => value);
    location.hash = new URLSearchParams(kept).toString();
  },
};
