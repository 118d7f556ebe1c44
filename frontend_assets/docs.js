// The API's own description, readable without anything from elsewhere.
"use strict";

function add(parent, name, text, attributes = {}) {
  const element = document.createElement(name);
  if (text !== undefined) element.textContent = text;
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  parent.append(element);
  return element;
}

function fields(api, schema) {
  const name = schema?.$ref?.split("/").at(-1);
  return name ? [name, api.components.schemas[name]] : ["", schema];
}

function addParameters(section, operation) {
  if (!operation.parameters?.length) return;
  const table = add(section, "table");
  for (const parameter of operation.parameters) {
    const row = add(table, "tr");
    add(row, "td", `${parameter.name} (${parameter.in})`);
    const { description = "", ...schema } = parameter.schema ?? {};
    add(row, "td", parameter.description ?? description);
    add(row, "td", JSON.stringify(schema));
  }
}

function addExamples(section, operation, path) {
  const json = operation.requestBody?.content?.["application/json"];
  for (const example of Object.values(json?.examples ?? {})) {
    add(section, "h3", example.summary);
    const body = JSON.stringify(example.value);
    const quoted = body.replaceAll("'", "'\\''");
    add(section, "pre", `curl -X POST ${location.origin}${path} -H 'Content-Type: application/json' \\\n  -d '${quoted}'`);
  }
}

function addAnswer(section, api, operation) {
  const answer = Object.entries(operation.responses ?? {}).find(([status]) => status.startsWith("2"));
  const schema = answer?.[1].content?.["application/json"]?.schema;
  if (!schema) return;
  const [name, meaning] = fields(api, schema);
  const details = add(section, "details");
  add(details, "summary", `Answers ${answer[0]}: ${name || "JSON"}`);
  add(details, "pre", JSON.stringify(meaning, null, 1));
}

async function show() {
  const place = document.getElementById("operations");
  const answer = await fetch("/api/openapi.json");
  if (!answer.ok) throw new Error(`the server answered ${answer.status}`);
  const api = await answer.json();
  document.querySelector("h1").textContent = `${api.info.title}: API, version ${api.info.version}`;
  document.querySelector(".why").textContent = api.info.description;
  place.textContent = "";
  for (const [path, methods] of Object.entries(api.paths)) {
    for (const [method, operation] of Object.entries(methods)) {
      const section = add(place, "section", undefined, { id: operation.operationId });
      add(section, "h2", `${method.toUpperCase()} ${path}`);
      add(section, "p", operation.description ?? operation.summary ?? "");
      addParameters(section, operation);
      addExamples(section, operation, path);
      addAnswer(section, api, operation);
    }
  }
}

show().catch((error) => {
  document.getElementById("operations").textContent = `The description cannot be loaded: ${error.message}. Reload this page.`;
});
