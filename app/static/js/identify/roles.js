// What each experiment is for: to fit the model to, to judge it by, or nothing.

import { h } from "../dom.js";
import { select } from "../forms.js";
import { pointLabel, quantity } from "../numbers.js";
import { table } from "../tables.js";

const ROLES = [["fitted", "fit to it"], ["heldOut", "hold out"], ["none", "leave out"]];

// {element, of(role)}: the identifiers of the experiments with a role.
export function roles(experiments, variables, unit) {
  const rows = experiments.map((one) => {
    const title = one.name || pointLabel(one.operatingPoint, variables);
    return { one, title, role: select(ROLES, start(one), { "aria-label": `What ${title} is for`, style: "width:auto" }) };
  });
  const set = (choose) => { for (const { one, role } of rows) role.value = choose(one); };
  const button = (label, choose) => h("button", { type: "button", class: "quiet", onclick: () => set(choose) }, label);
  const every = (_, place) => (place % 3 === 1 ? "heldOut" : "fitted");
  const places = new Map(byPoint(experiments).map((one, index) => [one.id, index]));
  const lines = rows.map(({ one, title, role }) => [title, pointLabel(one.operatingPoint, variables), role,
    one.understood.warnings.length ? String(one.understood.warnings.length) : "none", quantity(one.understood.noiseLevel, unit, 2)]);
  const element = h("div", { "data-pointer": "/experimentIds" },
    table({ columns: ["experiment", "operating point", "use", "warnings", "noise level"], rows: lines, textColumns: 3 }),
    h("p", { class: "actions" }, button("Fit to all", () => "fitted"), button("Hold out every third", (one) => every(one, places.get(one.id)))));
  return { element, of: (wanted) => rows.filter(({ role }) => role.value === wanted).map(({ one }) => one.id) };
}

const start = (experiment) => (/^held.?out/i.test(experiment.name) ? "heldOut" : "fitted");
const byPoint = (experiments) => [...experiments].sort((a, b) => a.operatingPoint[0] - b.operatingPoint[0] || a.id.localeCompare(b.id));
