// Two versions beside each other: frequency responses, parameters, effects, errors.

import { ratio } from "../compare/lack_of_fit.js";
import { h, replace } from "../dom.js";
import { field, select } from "../forms.js";
import { operatingPoints } from "../models/experiments.js";
import { parameterTable } from "../models/parameters.js";
import { ResponseView } from "../models/response_view.js";
import { effectsText, titleOf } from "../models/versions.js";
import { percent, probability, significant } from "../numbers.js";
import { table } from "../tables.js";

// line: versions, the first one first; steps: of the staircase.
export async function drawPair(place, { line, steps, plant, experiments }) {
  const choices = line.map((model, i) => [i, `${i + 1}. ${titleOf(model)}`]);
  const [left, right] = [select(choices, 0), select(choices, line.length - 1)];
  const [responses, numbers] = [h("div", {}), h("div", {})];
  replace(place, h("div", { class: "columns" }, field("left", left), field("right", right)), responses, numbers);
  const chosen = () => [left, right].map((one) => line[Number(one.value)]);
  const titled = () => chosen().map((model) => [`${line.indexOf(model) + 1}. ${titleOf(model)}`, model]);
  const used = experiments.filter((one) => line.some((model) => model.experimentIds.includes(one.id)));
  const points = operatingPoints(used.length ? used : experiments);
  const middle = plant.schedulingVariables.map((one) => (one.minimum + one.maximum) / 2);
  const view = new ResponseView(responses, { plant, points: points.length ? points : [middle], experiments: used.length ? used : experiments, models: titled() });
  const draw = () => {
    replace(numbers, errorTable(titled(), steps), parameterTable(titled(), plant));
    return view.show(titled());
  };
  left.addEventListener("change", draw);
  right.addEventListener("change", draw);
  await draw();
}

function errorTable(columns, steps) {
  const step = (model) => steps.find((one) => one.model === model);
  const rows = [
    ["effects", ([, model]) => effectsText(model)],
    ["error, fitted", ([, model]) => (step(model) ? percent(step(model).fitted) : "–")],
    ["error, held out", ([, model]) => (step(model) && step(model).heldOut != null ? percent(step(model).heldOut) : "–")],
    ["χ² per degree of freedom", ([, model]) => misfit(model, (test) => significant(ratio(test)))],
    ["p-value of the lack of fit", ([, model]) => misfit(model, (test) => probability(test.pValue))],
  ];
  return table({ caption: "Effects and errors", columns: ["what", ...columns.map(([title]) => title)], rows: rows.map(([what, valueOf]) => [what, ...columns.map(valueOf)]) });

  function misfit(model, text) {
    const found = step(model)?.lackOfFit;
    return found ? text(found) : "–";
  }
}
