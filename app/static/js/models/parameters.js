// The parameters of models with their standard deviations, of one or of several models beside each other.

import { h } from "../dom.js";
import { estimate } from "../numbers.js";
import { table } from "../tables.js";
import { effectText } from "./effects.js";

const MOST = 400;

// columns: [[head, model], …]; θ first, then the effects.
export function parameterTable(columns, plant) {
  const names = [...new Set(columns.flatMap(([, model]) => model.parameterNames))];
  const rows = names.slice(0, MOST).map((name) => [name, ...columns.map(([, model]) => valueOf(model, name))]);
  const effects = [...new Set(columns.flatMap(([, model]) => model.effects.map((one) => one.kind)))];
  const effectRows = effects.map((kind) => [columns.flatMap(([, model]) => model.effects).find((one) => one.kind === kind).title,
    ...columns.map(([, model]) => model.effects.filter((one) => one.kind === kind).map((one) => effectText(one, plant)).join(" and ") || "–")]);
  const more = names.length > MOST ? h("p", { class: "hint" }, `The first ${MOST} of ${names.length} parameters.`) : null;
  return [table({ caption: "Estimate ± standard deviation", columns: ["parameter", ...columns.map(([head]) => head)], rows: [...rows, ...effectRows] }), more];
}

function valueOf(model, name) {
  const place = model.parameterNames.indexOf(name);
  return place < 0 ? "–" : estimate(model.theta[place], model.standardDeviations?.[place] ?? 0);
}
