// Lack of fit against what noise alone would give: overall, per operating point, per band, per class of lines.

import { logAxis } from "../log_axis.js";
import { estimate, hertz, labelled, pointLabel, probability, significant } from "../numbers.js";
import { faded, seriesColour, symbol } from "../palette.js";
import { axis, plot } from "../plots.js";
import { table } from "../tables.js";
import { colour } from "../theme.js";
import { nameOf } from "./residual_maps.js";

export const DOUBTFUL = 0.05;
const MOST_LABELS = 12;

// χ² per degree of freedom; null where nothing is known.
export function ratio(test) {
  return test && test.statistic != null && test.degreesOfFreedom > 0 ? test.statistic / test.degreesOfFreedom : null;
}

// The plots of all places that there are tests of.
export function misfitPlots(place, parts, variables) {
  const bandLabel = (band) => (band.maximumRadPerSecond == null ? `above ${significant(hertz(band.minimumRadPerSecond), 2)}`
    : `${significant(hertz(band.minimumRadPerSecond), 2)} to ${significant(hertz(band.maximumRadPerSecond), 2)}`);
  const points = [...new Map(parts.flatMap((part) => part.byPoint).map((one) => [JSON.stringify(one.operatingPoint), one.operatingPoint])).values()];
  points.sort((a, b) => a[0] - b[0]);
  const several = variables.length > 1;
  const name = (point) => (several ? pointLabel(point, variables) : String(Number(point[0].toPrecision(4))));
  const charts = [
    ["each operating point", several ? "" : labelled(variables[0].name, variables[0].unit), (part) => part.byPoint.map((one) => [name(one.operatingPoint), one.test]), points.map(name)],
    ["each band of frequencies", "frequency (Hz)", (part) => part.byBand.map((one) => [bandLabel(one), one.test])],
    ["each class of lines", "", (part) => part.byLineClass.map((one) => [one.name, one])],
  ];
  for (const [where, title, testsOf, order] of charts) {
    if (parts.some((part) => testsOf(part).length)) misfitPlot(place, parts, { where, title, testsOf, order });
  }
}

function misfitPlot(place, parts, { where, title, testsOf, order }) {
  const given = parts.map((part) => [part, testsOf(part).filter(([, test]) => ratio(test) != null)]);
  const categories = order ?? [...new Set(given.flatMap(([, tests]) => tests.map(([label]) => label)))];
  return plot(place, {
    caption: `Misfit in ${where}: χ² per degree of freedom, 1 where only noise is left. Grey: 95 % of what noise alone gives.`,
    height: 300,
    draw: () => ({
      data: given.map(([part, tests], i) => pointTrace(part, tests, categories, i)),
      layout: { shapes: given.flatMap(([, tests], i) => tests.map((one) => range(one, categories, i))), xaxis: axis(title, { tickvals: categories.map((_, i) => i), ticktext: categories.map((label, i) => (i % Math.ceil(categories.length / MOST_LABELS) ? "" : label)), range: [-0.5, categories.length - 0.5], showgrid: false }), yaxis: logAxis("χ² per degree", [0.5, 2, ...given.flatMap(([, tests]) => tests.map(([, test]) => ratio(test)))]) },
    }),
    table: () => ({ columns: ["where", "data", "χ²", "degrees of freedom", "χ² per degree", "p-value"], textColumns: 2,
      rows: given.flatMap(([part, tests]) => tests.map(([label, test]) => [label, nameOf(part), significant(test.statistic, 4), significant(test.degreesOfFreedom, 4), significant(ratio(test)), probability(test.pValue)])) }),
  });
}

const shift = (i) => 0.18 * (i - 0.5);

// What 95 % of noise alone gives.
function range([label, test], categories, i) {
  const x = categories.indexOf(label) + shift(i);
  return { type: "rect", layer: "below", x0: x - 0.06, x1: x + 0.06, y0: limit(test, -1.96), y1: limit(test, 1.96), line: { width: 0 }, fillcolor: faded(colour("--edge"), 0.5) };
}

// Wilson and Hilferty's approximation of a quantile of χ²(d)/d.
function limit(test, quantile) {
  const part = 2 / (9 * test.degreesOfFreedom);
  return Math.max(1 - part + quantile * Math.sqrt(part), 0.05) ** 3;
}

function pointTrace(part, tests, categories, i) {
  return {
    x: tests.map(([label]) => categories.indexOf(label) + shift(i)), y: tests.map(([, test]) => ratio(test)), mode: "markers", name: nameOf(part),
    text: tests.map(([label, test]) => `${label}: p-value ${probability(test.pValue)}`), hovertemplate: "%{text}<br>%{y:.3g}",
    marker: { symbol: symbol(i), size: 10, color: seriesColour(i) },
  };
}

// What the tests of the whole say.
export function overallTable(parts) {
  const rows = parts.flatMap((part) => [
    ["is there anything but noise?", part.lackOfFit], ["would there be after a refit?", part.refitted], ["is the dependence on the operating point wrong?", part.dependence],
    ["are the dynamics wrong even at one operating point?", part.dynamics],
    ...part.simulationErrors.map((test) => [`is the simulation error suspicious? (${test.name})`, test]),
    ...part.betweenHarmonics.length ? [["is there a disturbance of its own frequency?", strongest(part.betweenHarmonics)]] : [],
  ].filter(([, test]) => test).map(([question, test]) => [question, nameOf(part), answer(test), significant(ratio(test)), probability(test.pValue)]));
  return table({ caption: "What the tests say; a p-value below 0.05 comes up once in twenty even if nothing is wrong", columns: ["question", "data", "answer", "χ² per degree of freedom", "p-value"], rows, textColumns: 3 });
}

// Sine waves of their own frequency, in the experiments that have one.
export function disturbanceTable(parts, titles, output) {
  const found = parts.flatMap((part) => part.disturbances);
  if (!found.length) return null;
  const rows = found.map((one) => [titles.get(one.experimentId) ?? one.experimentId, estimate(hertz(one.frequencyRadPerSecond), hertz(one.frequencyDeviationRadPerSecond)), estimate(one.amplitude, one.amplitudeDeviation), probability(one.pValue)]);
  return table({ caption: "The strongest disturbance of its own frequency, such as hum", columns: ["experiment", "frequency (Hz)", labelled("amplitude", output?.unit), "p-value"], rows });
}

// The smallest of several p-values, held against having looked so often.
function strongest(tests) {
  const known = tests.filter((test) => test.pValue != null);
  if (!known.length) return null;
  const least = known.reduce((a, b) => (a.pValue < b.pValue ? a : b));
  return { ...least, pValue: Math.min(1, least.pValue * known.length) };
}

const answer = (test) => (test.pValue == null ? "not known" : test.pValue < 1e-3 ? "yes" : test.pValue < DOUBTFUL ? "perhaps" : "no sign of it");
