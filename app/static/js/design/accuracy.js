// The accuracy of the parameters: asked for, before, and after the experiments.

import { significant } from "../numbers.js";
import { axis, plot } from "../plots.js";

// `model`: the one that the design began with.
export function drawAccuracy(place, design, model) {
  const after = design.expectedStandardDeviations;
  if (!after) return null;
  const names = design.parameterNames;
  // The parameters of effects, which the design has besides, are not in theta.
  const of = (values) => values && names.map((name) => values[model.parameterNames.indexOf(name)] ?? null);
  const before = of(model.standardDeviations);
  const asked = of(askedFor(design, model.parameterNames.length));
  const theta = of(model.theta);
  const series = [["asked for", asked, "line-ew-open"], ["before", before, "circle-open"], ["after", after, "circle"]].filter(([, values]) => values?.some((one) => one != null));
  const caption = before ? `Standard deviations of the parameters, before and after the experiments${design.request.usePriorInformation ? "" : " alone, what was known before not counted in"}.` : "Standard deviations of the parameters after the experiments; nothing is known of them before.";
  return plot(place, {
    caption, height: 300,
    draw: () => ({
      data: series.map(([name, values, symbol]) => ({ x: names, y: values, name, mode: "markers", marker: { symbol, size: symbol.startsWith("line") ? 22 : 11, line: { width: 2.5 } } })),
      layout: { xaxis: axis("", { type: "category" }), yaxis: axis("standard deviation", { log: true }), showlegend: true },
    }),
    table: () => ({ columns: ["parameter", "value", ...series.map(([name]) => name)],
      rows: names.map((name, i) => [name, significant(theta[i], 4), ...series.map(([, values]) => (values[i] == null ? "–" : significant(values[i])))]) }),
  });
}

// The strictest standard deviation that any target asks for directly; null where none does.
function askedFor(design, count) {
  const lists = design.request.targets.filter((one) => one.kind === "parameter_deviation").map((one) => one.standardDeviations);
  if (!lists.length) return null;
  return Array.from({ length: count }, (_, i) => {
    const values = lists.map((each) => each[i]).filter((one) => one != null);
    return values.length ? Math.min(...values) : null;
  });
}
