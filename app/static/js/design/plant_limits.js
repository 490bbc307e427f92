// The list of what the plant may not do in a new design: limits of the catalogue.

import { h, replace } from "../dom.js";
import { pluginField } from "../plugin_field.js";

// {element, value()}
export function plantLimits(catalogue) {
  const place = h("div", { "data-pointer": "/limits" });
  const rows = [];
  const draw = () => replace(place, rows.map((row, index) => h("div", { class: "panel", "data-pointer": `/limits/${index}` }, row.element,
    h("p", { class: "actions" }, h("button", { type: "button", class: "quiet", onclick: () => remove(row) }, `Remove limit ${index + 1}`)))));
  const remove = (row) => {
    rows.splice(rows.indexOf(row), 1);
    draw();
  };
  const another = () => {
    rows.push(pluginField("must not exceed", catalogue.limits, { pointer: `/limits/${rows.length}`, kind: "output_power" }));
    draw();
  };
  const add = h("button", { type: "button", class: "quiet", onclick: another }, "Add a limit of the plant");
  return { element: h("div", {}, place, h("p", { class: "actions" }, add)), value: () => rows.map((row) => row.value()) };
}

// One limit in words.
export function limitText(limit, plant) {
  const unit = { output_power: plant.output?.unit, input_power: plant.input?.unit }[limit.kind];
  const size = limit.rms == null ? "" : ` of ${limit.rms} ${unit || ""}`.trimEnd();
  return `${limit.kind.replaceAll("_", " ")}${size}`;
}
