// How coefficients depend on the scheduling variables: one family of functions for each variable.

import { h, replace } from "./dom.js";
import { field, fields, integerInput, numberOf } from "./forms.js";
import { pluginField } from "./plugin_field.js";

const START = { polynomial: { degree: 1 }, chebyshev: { degree: 3 }, b_spline: { degree: 3 } };

// {element, value(), setVariables(names)} for a basis at a JSON pointer of the request.
export function basisFields(entries, pointer, onChange, degree = 1) {
  const place = h("div", {});
  const total = integerInput(null, { min: 0 });
  const totalField = fields(field("highest sum of degrees", total, { hint: "empty: all products", pointer: `${pointer}/totalDegree` }));
  const factors = [];
  let titles = [];
  const setVariables = (names) => {
    const wanted = names.map((name, index) => `over ${name || `variable ${index + 1}`}`);
    if (wanted.join() === titles.join()) return; // moving a field that is being filled in would take the focus from it
    titles = wanted;
    while (factors.length > names.length) factors.pop();
    while (factors.length < names.length) factors.push(factor(factors.length));
    replace(place, factors.map((one, index) => h("div", {}, h("h3", {}, titles[index]), one.element)));
    totalField.hidden = names.length < 2;
  };
  const factor = (index) => pluginField("functions", entries, {
    pointer: `${pointer}/factors/${index}`, kind: "polynomial", values: { ...START, polynomial: { degree } }, onChange,
  });
  total.addEventListener("input", onChange);
  const value = () => ({ factors: factors.map((one) => one.value()), totalDegree: factors.length > 1 ? numberOf(total) : null });
  return { element: h("div", {}, place, totalField), value, setVariables };
}
