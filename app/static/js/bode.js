// A Bode plot: models with their 95 % bands, measured points with theirs, gain above phase on one frequency axis.

import { logAxis } from "./log_axis.js";
import { hertz, significant } from "./numbers.js";
import { dash, faded, seriesColour, symbol } from "./palette.js";
import { axis, plot } from "./plots.js";
import { colour } from "./theme.js";

const DEGREES = 180 / Math.PI;
const NORMAL_95 = 1.96;
const MOST_POINTS = 350;

// curves: [{name, response}] with documents of /frequency-response; points: [{name, frequencies (rad/s), response,
// deviation or null, hollow}]; misfit: what is left between measured and modelled {frequencies, size, noise or null}, or
// null; mark: a frequency (rad/s) to point at, or null; unit: of the gain.
export function bodePlot(place, { curves, points, misfit = null, mark = null, unit = "", caption, height = 460 }) {
  const drawn = { curves: curves.map(curveOf), points: points.map((one) => pointsOf(one, curves[0]?.response)), misfit: misfit && misfitOf(misfit) };
  const few = { points: drawn.points.map(thinnedOut), misfit: drawn.misfit && thinnedOut(drawn.misfit) };
  const every = strideOf(drawn.points[0]?.x ?? []);
  return plot(place, {
    caption: every > 1 ? `${caption} One in ${every} points is drawn.` : caption, height,
    draw: () => ({ data: [...drawn.curves.flatMap(curveTraces), ...few.points.flatMap((one, i) => pointTraces(one, i + drawn.curves.length)), ...misfitTraces(few.misfit)], layout: layout(drawn, mark, unit) }),
    table: () => tableOf(drawn, unit),
  });
}

function curveOf({ name, response: given }) {
  const degrees = (values) => values?.map((one) => DEGREES * one) ?? null;
  return {
    name, x: given.frequenciesRadPerSecond.map(hertz), gain: given.magnitude, phase: degrees(given.phaseRad),
    gainBand: given.magnitudeLower95 && [given.magnitudeLower95, given.magnitudeUpper95],
    phaseBand: given.phaseLower95Rad && [degrees(given.phaseLower95Rad), degrees(given.phaseUpper95Rad)],
  };
}

// Measured values as gain and phase, the latter near that of the model.
function pointsOf({ name, frequencies, response, deviation, hollow = false }, model) {
  const places = frequencies.map((_, i) => i).filter((i) => frequencies[i] > 0);
  const gain = places.map((i) => Math.hypot(response.re[i], response.im[i]));
  const phase = places.map((i) => near(Math.atan2(response.im[i], response.re[i]), model, frequencies[i]));
  const halves = deviation && places.map((i) => (NORMAL_95 * deviation[i]) / Math.SQRT2);
  return {
    name, hollow, gain, x: places.map((i) => hertz(frequencies[i])), phase: phase.map((one) => DEGREES * one),
    gainError: halves, phaseError: halves?.map((one, i) => Math.min(DEGREES * (one / Math.max(gain[i], 1e-300)), 180)) ?? null,
  };
}

function misfitOf({ frequencies, size, noise }) {
  const places = frequencies.map((_, i) => i).filter((i) => frequencies[i] > 0);
  return { x: places.map((i) => hertz(frequencies[i])), size: places.map((i) => size[i]), noise: noise && places.map((i) => noise[i]) };
}

const strideOf = (values) => Math.ceil(values.length / MOST_POINTS);

// So few points that they can be told apart and are drawn soon; the table has all.
function thinnedOut(one) {
  const stride = strideOf(one.x);
  return Object.fromEntries(Object.entries(one).map(([key, value]) => [key, Array.isArray(value) ? value.filter((_, i) => i % stride === 0) : value]));
}

function near(phase, model, frequency) {
  if (!model) return phase;
  const { frequenciesRadPerSecond: omega, phaseRad } = model;
  let i = omega.findIndex((one) => one >= frequency);
  if (i < 0) i = omega.length - 1;
  const share = i > 0 && omega[i] > omega[i - 1] ? (frequency - omega[i - 1]) / (omega[i] - omega[i - 1]) : 1;
  const said = phaseRad[Math.max(i - 1, 0)] * (1 - share) + phaseRad[i] * share;
  return phase + 2 * Math.PI * Math.round((said - phase) / (2 * Math.PI));
}

function curveTraces(curve, i) {
  const line = { color: seriesColour(i), dash: dash(i), width: 2.2 };
  const fill = faded(seriesColour(i), 0.22);
  const common = { x: curve.x, mode: "lines", name: curve.name, legendgroup: `curve ${i}` };
  const band = (pair, yaxis) => pair && {
    x: [...curve.x, ...[...curve.x].reverse()], y: [...pair[1], ...[...pair[0]].reverse()], yaxis, fill: "toself", fillcolor: fill,
    line: { width: 0 }, mode: "lines", hoverinfo: "skip", name: `${curve.name}, 95 %`, legendgroup: `curve ${i}`, showlegend: false,
  };
  return [band(curve.gainBand, "y"), band(curve.phaseBand, "y2"), { ...common, y: curve.gain, line }, { ...common, y: curve.phase, yaxis: "y2", line, showlegend: false }].filter(Boolean);
}

function pointTraces(one, i) {
  const shape = symbol(i) + (one.hollow ? "-open" : "");
  const marker = { symbol: shape, size: one.hollow ? 8 : 5, color: one.hollow ? seriesColour(i) : colour("--ink"), line: { width: 1.2, color: seriesColour(i) } };
  const common = { x: one.x, mode: "markers", name: one.name, legendgroup: `points ${i}`, marker };
  const bars = one.gainError ? [barTrace(one, "gain", "y", i), barTrace(one, "phase", "y2", i)] : [];
  return [...bars, { ...common, y: one.gain }, { ...common, y: one.phase, yaxis: "y2", showlegend: false }];
}

// All bars as one line with gaps, which is drawn far sooner than bars of their own.
function barTrace(one, key, yaxis, i) {
  const half = one[`${key}Error`];
  const ends = one[key].flatMap((value, j) => [key === "gain" ? Math.max(value - half[j], value / 100) : value - half[j], value + half[j], null]);
  const line = { color: faded(colour("--quiet"), 0.8), width: 1 };
  return { x: one.x.flatMap((x) => [x, x, null]), y: ends, yaxis, mode: "lines", line, hoverinfo: "skip", showlegend: false, legendgroup: `points ${i}` };
}

function misfitTraces(misfit) {
  if (!misfit) return [];
  const common = { x: misfit.x, legendgroup: "misfit" };
  return [
    misfit.noise && { ...common, y: misfit.noise, mode: "lines", name: "noise", line: { color: colour("--quiet"), width: 1.6, dash: "dot" } },
    { ...common, y: misfit.size, mode: "markers", name: "difference", marker: { symbol: "x-thin", size: 6, line: { width: 1.6, color: seriesColour(3) } } },
  ].filter(Boolean);
}

function layout({ curves, points, misfit }, mark, unit) {
  const all = [...curves, ...points];
  const frequencies = all.flatMap((one) => one.x);
  const floor = misfit ? [...(misfit.noise ?? []), ...misfit.size.filter((one, i) => one > (misfit.noise?.[i] ?? 0) / 2)] : [];
  const gains = [...all.flatMap((one) => one.gain), ...floor].filter((one) => one > 0);
  const shown = [Math.min(...gains), Math.max(...gains)].map(Math.log10);
  return {
    xaxis: logAxis("frequency (Hz)", frequencies, { anchor: "y2" }),
    yaxis: logAxis(unit ? `gain (${unit})` : "gain", gains, { domain: [0.42, 1], range: [shown[0] - 0.1, shown[1] + 0.1] }),
    yaxis2: axis("phase (°)", { domain: [0, 0.34] }),
    shapes: mark > 0 ? [{ type: "line", xref: "x", yref: "paper", x0: hertz(mark), x1: hertz(mark), y0: 0, y1: 1, line: { color: colour("--edge"), dash: "dot", width: 2 } }] : [],
  };
}

function tableOf({ curves, points, misfit }, unit) {
  const gain = unit ? `gain (${unit})` : "gain";
  const rows = [...points, ...curves].flatMap((one) => one.x.map((x, i) => [
    one.name, significant(x, 4), significant(one.gain[i], 4), significant(one.phase[i], 4),
    one.gainBand ? `${significant(one.gainBand[0][i])} … ${significant(one.gainBand[1][i])}` : one.gainError ? `± ${significant(one.gainError[i], 2)}` : ""]));
  if (misfit) rows.push(...misfit.x.map((x, i) => ["difference", significant(x, 4), significant(misfit.size[i]), "", misfit.noise ? `noise ${significant(misfit.noise[i])}` : ""]));
  return { columns: ["what", "frequency (Hz)", gain, "phase (°)", "95 % of the gain"], rows };
}
