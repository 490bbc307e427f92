// Models as versions of each other: which came from which, and what they were fitted to.

import { moment } from "../numbers.js";

const ORIGINS = { identified: "Identified model", stated: "Stated model", extended: "Extended model" };

export const indexed = (items) => new Map(items.map((one) => [one.id, one]));

// A model and those before it, the first one first; `models`: of the plant, by their identifiers.
export function lineage(model, models) {
  const line = [];
  for (let one = model; one && !line.includes(one); one = models.get(one.parentId)) line.unshift(one);
  return line;
}

// The identifiers of all experiments that a model or one before it was fitted to.
export function fittedTo(model, models) {
  return new Set(lineage(model, models).flatMap((one) => one.experimentIds));
}

// The latest version of each line of versions, newest first as given.
export function latest(items) {
  const parents = new Set(items.map((one) => one.parentId));
  return items.filter((one) => !parents.has(one.id));
}

// What to call a model.
export function titleOf(model) {
  if (model.name) return model.name;
  const last = model.effects.at(-1);
  return model.origin === "extended" && last ? `With ${last.title}` : ORIGINS[model.origin];
}

export const datedTitle = (model) => `${titleOf(model)}, ${moment(model.createdAt)}`;

// The effects of a model in a few words.
export function effectsText(model) {
  return model.effects.map((one) => one.title).join(", ") || "none";
}
