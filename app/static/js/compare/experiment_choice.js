// Which experiments to take: a table of them with a box each.

import { h } from "../dom.js";
import { checkbox, group } from "../forms.js";
import { experimentTitle, pointText, sorted } from "../models/experiments.js";
import { table } from "../tables.js";

// {element, value()}: identifiers of what is ticked; `notes(experiment)` stands in the last column.
export function experimentChoice({ legend, experiments, variables, ticked, notes, pointer, hint = "" }) {
  const rows = sorted(experiments).map((one) => ({ one, box: checkbox(ticked(one), { "aria-label": experimentTitle(one, variables) }), note: notes(one) }));
  const tick = (wanted) => { for (const { one, box } of rows) box.checked = wanted(one); };
  const button = (label, wanted) => h("button", { type: "button", class: "quiet", onclick: () => tick(wanted) }, label);
  const lines = rows.map(({ one, box, note }) => [h("span", { class: "check" }, box, h("span", {}, experimentTitle(one, variables))), pointText(one.operatingPoint, variables), note]);
  const element = group(legend, hint ? h("p", { class: "hint" }, hint) : null,
    h("div", { "data-pointer": pointer }, table({ columns: ["experiment", "operating point", ""], rows: lines, textColumns: 3, caption: "" })),
    h("p", { class: "actions" }, button("All", () => true), button("None", () => false)));
  return { element, value: () => rows.filter((row) => row.box.checked).map((row) => row.one.id) };
}
