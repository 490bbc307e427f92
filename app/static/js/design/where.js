// Where experiments may be done: an equidistant grid, a box, or points one by one.

import { h, replace } from "../dom.js";
import { field, fields, integerInput, numberInput, numberOf, select, textInput } from "../forms.js";
import { labelled } from "../numbers.js";
import { pointsIn } from "./grids.js";

const KINDS = [["gridAxes", "a grid of equidistant values"], ["box", "anywhere in the range; the search refines where it pays"], ["grid", "points one by one"]];

// {element, value()}: operatingPoints and excludedPoints of a request.
export function where(variables) {
  const kind = select(KINDS, "gridAxes");
  const place = h("div", { "data-pointer": "/operatingPoints" });
  const excluded = textInput();
  const rows = variables.map((one) => ({ minimum: numberInput(one.minimum), maximum: numberInput(one.maximum), count: integerInput(variables.length > 1 ? 7 : 17, { min: 1 }) }));
  const starting = integerInput(17, { min: 2, max: 101 });
  const points = h("textarea", { rows: 3 });
  const draw = () => replace(place, contents(kind.value, variables, rows, starting, points));
  kind.addEventListener("change", draw);
  draw();
  const value = () => ({ operatingPoints: stated(kind.value, rows, starting, pointsIn(points.value, variables.length)), excludedPoints: pointsIn(excluded.value, variables.length) });
  const element = h("div", {}, fields(field("where experiments may be done", kind, { wide: true })), place,
    fields(field("but not at", excluded, { hint: "operating points, separated by semicolons", pointer: "/excludedPoints" })));
  return { element, value };
}

function contents(kind, variables, rows, starting, points) {
  if (kind === "grid") {
    const hint = variables.length > 1 ? `${variables.map((one) => one.name).join(", ")} of each point, one point a line` : "separated by spaces";
    return fields(field("operating points", points, { hint, pointer: "/operatingPoints/points", wide: true }));
  }
  const each = rows.map((row, i) => {
    const at = (name) => (kind === "box" ? `/operatingPoints/${name}/${i}` : `/operatingPoints/axes/${i}/${name}`);
    const title = labelled(variables[i].name, variables[i].unit);
    return [field(`${title} from`, row.minimum, { pointer: at("minimum") }), field("to", row.maximum, { pointer: at("maximum") }),
      kind === "box" ? null : field("values", row.count, { pointer: at("count") })];
  });
  const first = kind === "box" ? fields(field("values of each to begin with", starting, { pointer: "/operatingPoints/startingCount" })) : null;
  return [each.map((one) => fields(one)), first];
}

function stated(kind, rows, starting, points) {
  if (kind === "grid") return { kind, points };
  const values = (name) => rows.map((row) => numberOf(row[name]));
  if (kind === "box") return { kind, minimum: values("minimum"), maximum: values("maximum"), startingCount: numberOf(starting) };
  return { kind, axes: rows.map((row) => ({ minimum: numberOf(row.minimum), maximum: numberOf(row.maximum), count: numberOf(row.count) })) };
}
