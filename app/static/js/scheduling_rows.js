// The scheduling variables of a plant: a row of fields each.

import { h, replace } from "./dom.js";
import { field, fields, numberInput, numberOf, textInput } from "./forms.js";

const MOST = 10;

// {element, value()}; `onChange` when anything has changed.
export function schedulingRows(onChange) {
  const place = h("div", {});
  const add = h("button", { type: "button", class: "quiet" }, "Add another variable");
  const rows = [];
  const draw = () => {
    replace(place, rows.map((row, index) => rowElement(row, index, rows.length > 1 ? () => remove(index) : null)));
    add.hidden = rows.length >= MOST;
  };
  const remove = (index) => {
    rows.splice(index, 1);
    draw();
    onChange();
  };
  const another = () => {
    rows.push({ name: textInput("", { required: true }), unit: textInput(), minimum: numberInput(0), maximum: numberInput(1) });
    draw();
  };
  add.addEventListener("click", () => {
    another();
    onChange();
  });
  another();
  const value = () => rows.map((row) => ({
    name: row.name.value.trim(), unit: row.unit.value.trim(), minimum: numberOf(row.minimum), maximum: numberOf(row.maximum),
  }));
  return { element: h("div", { oninput: onChange }, place, h("p", { class: "actions" }, add)), value };
}

function rowElement(row, index, remove) {
  const at = (name) => `/schedulingVariables/${index}/${name}`;
  return h("div", { "data-pointer": `/schedulingVariables/${index}` }, fields(
    field("name", row.name, { hint: "e.g. speed", pointer: at("name") }),
    field("unit", row.unit, { hint: "e.g. m/s", pointer: at("unit") }),
    field("least value", row.minimum, { pointer: at("minimum") }),
    field("largest value", row.maximum, { pointer: at("maximum") }),
    remove && h("p", { class: "actions" }, h("button", { type: "button", class: "quiet", onclick: remove }, `Remove variable ${index + 1}`))));
}
