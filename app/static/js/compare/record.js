// The record of an experiment: input and output over its last period, on one time axis.

import { get } from "../api.js";
import { h } from "../dom.js";
import { labelled, significant } from "../numbers.js";
import { dash, seriesColour } from "../palette.js";
import { axis, plot, thinned } from "../plots.js";
import { drawRecord } from "../record_plots.js";

// Draw the record of an experiment of a plant; frequency responses have none, and say so.
export async function recordPlot(place, experiment, plant) {
  if (experiment.kind === "varyingRecord") {
    const { inputs, outputs, sampleTimeSeconds, scheduling } = await get(`/experiments/${experiment.id}/data`);
    return drawRecord(place, plant, inputs, outputs, sampleTimeSeconds, experiment.understood.periodSamples, scheduling);
  }
  if (experiment.kind !== "timeRecord") {
    return place.append(h("p", { class: "hint" }, "This experiment is a frequency response; there is no record of it."));
  }
  const data = await get(`/experiments/${experiment.id}/data`);
  const { periodSamples: period, periods } = experiment.understood;
  const start = period && periods > 1 ? (periods - 1) * period : 0;
  const stop = period && periods ? periods * period : data.input.length;
  const time = Array.from({ length: stop - start }, (_, i) => (start + i) * data.sampleTimeSeconds);
  const [u, y] = [data.input, data.output].map((one) => one.slice(start, stop));
  const [input, output] = [plant.input, plant.output].map((one) => labelled(one.name, one.unit));
  const curve = (values, i) => ({ ...thinned(time, values), mode: "lines", yaxis: i ? "y" : "y2", showlegend: false, name: i ? output : input, line: { color: seriesColour(i), dash: dash(0), width: 1.4 } });
  return plot(place, {
    caption: period ? `The record: the last of ${periods} periods.` : "The record.", height: 300,
    draw: () => ({ data: [curve(u, 0), curve(y, 1)], layout: { xaxis: axis("time (s)", { anchor: "y" }), yaxis: axis(output, { domain: [0, 0.46] }), yaxis2: axis(input, { domain: [0.54, 1] }) } }),
    table: () => ({ columns: ["time (s)", input, output], rows: time.map((t, i) => [significant(t, 5), significant(u[i], 4), significant(y[i], 4)]) }),
  });
}
