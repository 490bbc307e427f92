// The list of accuracy targets of a new design.

import { h, replace } from "../dom.js";
import { field, select } from "../forms.js";
import { targetFields, targetTitle } from "./target_fields.js";

// {element, value()}
export function targets(catalogue, plant) {
  const ordered = [...catalogue.targets].sort((a, b) => Number(b.kind === "response_deviation") - Number(a.kind === "response_deviation"));
  const place = h("div", { "data-pointer": "/targets" });
  const rows = [];
  const draw = () => replace(place, rows.map((row, index) => element(row, index)));
  const element = (row, index) => h("div", { class: "panel", "data-pointer": `/targets/${index}` },
    field("know", row.kind), row.fields.element,
    rows.length > 1 ? h("p", { class: "actions" }, h("button", { type: "button", class: "quiet", onclick: () => remove(index) }, `Remove target ${index + 1}`)) : null);
  const renew = (row, index) => {
    row.fields = targetFields(catalogue.targets.find((one) => one.kind === row.kind.value), plant, catalogue, `/targets/${index}`);
  };
  const remove = (index) => {
    rows.splice(index, 1);
    draw();
  };
  const another = () => {
    const row = { kind: select(ordered.map((one) => [one.kind, targetTitle(one.kind)])) };
    row.kind.addEventListener("change", () => {
      renew(row, rows.indexOf(row));
      draw();
    });
    rows.push(row);
    renew(row, rows.length - 1);
    draw();
  };
  another();
  const add = h("button", { type: "button", class: "quiet", onclick: another }, "Add another target");
  return { element: h("div", {}, place, h("p", { class: "actions" }, add)), value: () => rows.map((row) => row.fields.value()) };
}
