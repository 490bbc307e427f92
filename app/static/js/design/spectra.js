// Energy per operating point, and the spectra over operating points and frequency.

import { h, replace } from "../dom.js";
import { FieldMap } from "../map.js";
import { hertz, labelled, pointLabel, quantity, significant } from "../numbers.js";
import { dash, symbol } from "../palette.js";
import { axis, plot } from "../plots.js";
import { colour } from "../theme.js";

const MOST_CURVES = 6;

export const energyUnit = (plant) => (plant.input.unit ? `${plant.input.unit}²` : "");

// Bars over the first scheduling variable, or over the points where there are several.
export function drawEnergies(place, plant, design) {
  const { experiments } = design;
  const one = plant.schedulingVariables.length === 1;
  const labels = experiments.map((each) => pointLabel(each.operatingPoint, plant.schedulingVariables));
  const variable = plant.schedulingVariables[0];
  const range = variable.maximum - variable.minimum;
  const caps = design.request.energyCaps?.default;
  return plot(place, {
    caption: `Input energy at each operating point${caps ? "; dotted, the limit" : ""}.`, height: 260,
    draw: () => ({
      data: [{ type: "bar", x: one ? experiments.map((each) => each.operatingPoint[0]) : labels, y: experiments.map((each) => each.energy),
        text: labels, textposition: "none", width: one ? range / 60 : undefined, marker: { color: colour("--series-1") }, hovertemplate: "%{text}: %{y:.4g}<extra></extra>" }],
      layout: {
        xaxis: one ? axis(labelled(variable.name, variable.unit), { range: [variable.minimum - range / 30, variable.maximum + range / 30] }) : axis("", { type: "category" }),
        yaxis: axis(labelled("energy Σu²", energyUnit(plant)), { rangemode: "tozero" }),
        shapes: caps ? [{ type: "line", xref: "paper", x0: 0, x1: 1, y0: caps, y1: caps, line: { dash: "dot", color: colour("--series-2") } }] : [],
      },
    }),
    table: () => ({ columns: ["operating point", labelled("energy", energyUnit(plant))], rows: experiments.map((each, i) => [labels[i], significant(each.energy, 5)]) }),
  });
}

// A map over operating point and frequency where there are many, curves of single points beside it.
export function drawSpectra(place, plant, design) {
  const { experiments } = design;
  if (!experiments.length) return;
  const inner = h("div", {});
  const show = (indices) => {
    replace(inner);
    drawCurves(inner, plant, indices.map((index) => experiments[index]));
  };
  if (experiments.length > MOST_CURVES) drawMap(place, plant, experiments, (row) => show([row]));
  place.append(inner);
  show(experiments.slice(0, MOST_CURVES).map((_, index) => index));
}

function drawMap(place, plant, experiments, onChoose) {
  const labels = experiments.map((one) => pointLabel(one.operatingPoint, plant.schedulingVariables));
  const most = Math.max(...experiments.flatMap((one) => one.curve.values));
  new FieldMap(place, {
    rows: experiments.map((one, i) => ({ label: labels[i], frequencies: one.curve.frequenciesRadPerSecond.map(hertz), values: one.curve.values })),
    minimum: 0, maximum: most, kind: "sequential", log: false, frequencyTitle: "frequency (Hz)", valueTitle: valueTitle(experiments, plant),
    caption: "Spectra over operating points; a click shows one of them.", onChoose,
    describe: (row, column) => `${labels[row]}, ${quantity(hertz(experiments[row].curve.frequenciesRadPerSecond[column]), "Hz")}: ${quantity(experiments[row].curve.values[column], energyUnit(plant))}`,
  });
}

const valueTitle = (experiments, plant) => labelled(experiments.every((one) => one.spectrum.kind !== "fir") ? "energy of a line" : "energy density", energyUnit(plant));

function drawCurves(place, plant, experiments) {
  const labels = experiments.map((one) => pointLabel(one.operatingPoint, plant.schedulingVariables));
  const trace = (one, i) => {
    const x = one.curve.frequenciesRadPerSecond.map(hertz);
    const y = one.curve.values;
    if (one.spectrum.kind === "fir") return { x, y, name: labels[i], mode: "lines", line: { dash: dash(i), width: 2.2 } };
    return { x, y, name: labels[i], mode: "markers", marker: { symbol: symbol(i), size: 9 }, error_y: { type: "data", symmetric: false, array: y.map(() => 0), arrayminus: y, width: 0, thickness: 1.5 } };
  };
  return plot(place, {
    caption: "Spectrum of the input at each operating point.", height: 320,
    draw: () => ({ data: experiments.map(trace), layout: { xaxis: axis("frequency (Hz)", { rangemode: "tozero" }), yaxis: axis(valueTitle(experiments, plant), { rangemode: "tozero" }), showlegend: true } }),
    table: () => ({ columns: ["operating point", "frequency (Hz)", valueTitle(experiments, plant)],
      rows: experiments.flatMap((one, i) => one.curve.frequenciesRadPerSecond.map((omega, k) => [labels[i], significant(hertz(omega), 4), significant(one.curve.values[k])])) }),
  });
}
