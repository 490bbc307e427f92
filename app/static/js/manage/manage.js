// Rename, describe and delete the resource of a page; before deleting it is said what stands on it.

import { get, request } from "../api.js";
import { h, message, replace } from "../dom.js";
import { field, fields, submitButton, textInput } from "../forms.js";
import { showProblem } from "../problems.js";
import { counted, ownResource } from "./resource.js";
import { rememberDeletion } from "./undo.js";

const MOST_NAMED = 8;

// A part of the page that is filled when it is opened; null on pages that are about no one resource.
export function managePart() {
  const own = ownResource();
  if (!own) return null;
  const place = h("div", { "aria-live": "polite" });
  const details = h("details", { class: "manage" }, h("summary", {}, `Rename, describe or delete this ${own.word}`), place);
  details.addEventListener("toggle", () => { if (details.open && !place.children.length) show(place, own); });
  return details;
}

async function show(place, own) {
  const path = `/${own.collection}/${own.id}`;
  try {
    const [document, { items }] = await Promise.all([get(path), get(`${path}/dependents`)]);
    replace(place, renaming(path, document), deleting(path, own, document, items));
  } catch (problem) {
    showProblem(problem, { place });
  }
}

function renaming(path, document) {
  const holder = "name" in document ? document : document.request ?? {};
  const inputs = ["name", "description"].filter((key) => key in holder).map((key) => [key, textInput(holder[key] ?? "")]);
  if (!inputs.length) return null;
  const form = h("div", {}, fields(inputs.map(([key, input]) => field(key, input, { pointer: `/${key}`, wide: true }))));
  const keep = async () => {
    const changed = inputs.filter(([key, input]) => input.value !== (holder[key] ?? ""));
    if (!changed.length) return;
    try {
      await request(path, { method: "PATCH", headers: { "Content-Type": "application/json" }, body: JSON.stringify(Object.fromEntries(changed.map(([key, input]) => [key, input.value]))) });
      location.reload();
    } catch (problem) {
      showProblem(problem, { place: form, form });
    }
  };
  form.append(h("p", { class: "actions" }, submitButton("Keep these words", keep)));
  return form;
}

function deleting(path, own, document, items) {
  const place = h("div", {});
  const name = document.name || document.fileName || document.request?.name || `this ${own.word}`;
  const remove = async () => {
    try {
      await request(`${path}?withDependents=${items.length > 0}`, { method: "DELETE" });
      const others = items.length ? `, and with it ${summed(items)}` : "";
      rememberDeletion({ id: own.id, text: `Deleted: ${name}${others}.`, page: location.pathname });
      location.href = own.back;
    } catch (problem) {
      showProblem(problem, { place });
    }
  };
  const label = items.length ? `Delete with ${items.length === 1 ? "what stands on it" : `all ${items.length} that stand on it`}` : `Delete this ${own.word}`;
  place.append(items.length ? standing(own, items) : h("p", {}, `Nothing stands on this ${own.word}. What is deleted stays in the bin and can be brought back.`),
    h("p", { class: "actions" }, submitButton(label, remove, { class: "danger" })));
  return place;
}

function standing(own, items) {
  const names = items.filter((one) => one.name).map((one) => one.name);
  const more = names.length > MOST_NAMED ? ` and ${names.length - MOST_NAMED} more` : "";
  return message("warning", h("p", {}, `On this ${own.word} stand ${summed(items)}; they go into the bin with it, and come back with it.`),
    names.length ? h("p", { class: "hint" }, `Among them: ${names.slice(0, MOST_NAMED).join(", ")}${more}.`) : null);
}

// How many of each collection.
export function summed(items) {
  const counts = new Map();
  for (const { collection } of items) counts.set(collection, (counts.get(collection) ?? 0) + 1);
  return [...counts].map(([collection, count]) => counted(collection, count)).join(", ");
}
