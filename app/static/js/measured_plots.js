// The measured response of an experiment: Bode with noise, signal to noise per line, and of impedances Nyquist and the
// linear Kramers–Kronig test.

import { h, message } from "./dom.js";
import { hertz, labelled, percent, probability, significant } from "./numbers.js";
import { faded, seriesColour } from "./palette.js";
import { axis, linkAxes, plot } from "./plots.js";
import { unwrapped } from "./response_plots.js";
import { colour } from "./theme.js";

const METHODS = { periodicAverage: "averaged over the periods", localPolynomial: "by local polynomials, neighbours sharing data", given: "as it was brought in" };
const WRONG_SIGN = 0.2;

// found: a document of /frequency-response of an experiment.
export function drawMeasured(place, plant, found) {
  const kept = found.frequenciesRadPerSecond.map((_, i) => i).filter((i) => found.frequenciesRadPerSecond[i] > 0);
  const pick = (values) => values && kept.map((i) => values[i]);
  const response = { x: pick(found.frequenciesRadPerSecond).map(hertz), re: pick(found.response.re), im: pick(found.response.im), deviation: pick(found.standardDeviation)?.map((one) => one / Math.SQRT2) ?? null };
  response.gain = response.re.map((one, i) => Math.hypot(one, response.im[i]));
  response.phase = unwrapped(response);
  place.append(h("h2", {}, "Measured response"));
  const unit = gainUnit(plant);
  linkAxes([...bode(place, response, unit, METHODS[found.method]), ...ratioToNoise(place, response)]);
  if (found.kramersKronig) drawImpedance(place, response, unit, found.kramersKronig);
}

const gainUnit = ({ input, output }) => [output.unit, input.unit].filter(Boolean).join("/");
const frequencyAxis = ({ x }) => axis("frequency (Hz)", { log: x.length > 1 && Math.max(...x) / Math.min(...x) > 5 });

function bode(place, response, unit, method) {
  const { x, gain, phase, deviation } = response;
  const trace = (y, series) => ({ x, y, mode: x.length > 300 ? "lines" : "lines+markers", marker: { size: 4 }, line: { width: 1.2, color: seriesColour(series) }, name: "measured" });
  const halves = deviation && { gain: deviation, phase: deviation.map((one, i) => Math.min((180 / Math.PI) * (one / Math.max(gain[i], 1e-300)), 180)) };
  const table = () => ({ columns: ["frequency (Hz)", labelled("gain", unit), "gain (dB)", "phase (°)", labelled("standard deviation", unit)],
    rows: x.map((one, i) => [significant(one, 5), significant(gain[i], 5), significant(20 * Math.log10(gain[i]), 4), significant(phase[i], 4), deviation ? significant(deviation[i], 2) : "not known"]) });
  const [first, second] = [
    ["gain", gain, halves?.gain, axis(labelled("gain", unit), { log: true }), 320], ["phase", phase, halves?.phase, axis("phase (°)"), 240],
  ].map(([name, values, half, vertical, height]) => plot(place, {
    caption: `${name === "gain" ? "Gain" : "Phase"}, ${method}${half ? ", with one standard deviation" : "; its noise is not known"}.`, height, table,
    draw: () => ({ data: [...(half ? [band(x, values, half, name === "gain")] : []), trace(values, 0)], layout: { xaxis: frequencyAxis(response), yaxis: vertical, showlegend: false } }),
  }));
  return [first, second];
}

function band(x, y, half, positive) {
  const lower = y.map((one, i) => (positive ? Math.max(one - half[i], one / 100) : one - half[i]));
  return { x: [...x, ...[...x].reverse()], y: [...y.map((one, i) => one + half[i]), ...lower.reverse()], fill: "toself", fillcolor: faded(seriesColour(0), 0.3), line: { width: 0 }, mode: "lines", hoverinfo: "skip" };
}

function ratioToNoise(place, response) {
  const { x, gain, deviation } = response;
  if (!deviation || deviation.some((one) => !(one > 0))) return [];
  const decibel = gain.map((one, i) => 20 * Math.log10(one / (Math.SQRT2 * deviation[i])));
  return [plot(place, {
    caption: "Signal to noise of each line: 20 dB are 10 % of noise, below 0 dB the line says next to nothing.", height: 210,
    draw: () => ({ data: [{ x, y: decibel, mode: "lines", line: { width: 1.2, color: seriesColour(2) }, name: "signal to noise" }], layout: { xaxis: frequencyAxis(response), yaxis: axis("signal to noise (dB)"), showlegend: false } }),
    table: () => ({ columns: ["frequency (Hz)", "signal to noise (dB)"], rows: x.map((one, i) => [significant(one, 5), significant(decibel[i])]) }),
  })];
}

function drawImpedance(place, { x, re, im }, unit, test) {
  const minus = im.map((one) => -one);
  place.append(h("h2", {}, "Impedance"));
  plot(place, {
    caption: "Nyquist: minus the imaginary part over the real part, both at one scale; low frequencies are on the right.", height: 420,
    draw: () => ({ data: [{ x: re, y: minus, mode: "lines+markers", marker: { size: 5 }, line: { width: 1, color: seriesColour(0) }, text: x.map((one) => significant(one)), name: "impedance",
      hovertemplate: `%{text} Hz<br>${labelled("Re Z", unit)}: %{x:.4~g}<br>${labelled("−Im Z", unit)}: %{y:.4~g}<extra></extra>` }],
    layout: { xaxis: axis(labelled("Re Z", unit)), yaxis: axis(labelled("−Im Z", unit), { scaleanchor: "x", scaleratio: 1 }), showlegend: false } }),
    table: () => ({ columns: ["frequency (Hz)", labelled("Re Z", unit), labelled("−Im Z", unit)], rows: x.map((one, i) => [significant(one, 5), significant(re[i], 5), significant(minus[i], 5)]) }),
  });
  place.append(verdict(test));
  const percents = [test.residual.re, test.residual.im].map((values) => values.map((one) => 100 * one));
  plot(place, {
    caption: "What a chain of relaxations leaves of the impedance (linear Kramers–Kronig test): without form where all is well.", height: 240,
    draw: () => ({ data: percents.map((y, i) => ({ x, y, name: ["real part", "imaginary part"][i], mode: "lines+markers", marker: { size: 4 }, line: { width: 1, color: seriesColour(i) } })), layout: { xaxis: frequencyAxis({ x }), yaxis: axis("left over (% of |Z|)", { zeroline: true, zerolinecolor: colour("--edge") }) } }),
    table: () => ({ columns: ["frequency (Hz)", "real part (%)", "imaginary part (%)"], rows: x.map((one, i) => [significant(one, 5), significant(percents[0][i]), significant(percents[1][i])]) }),
  });
}

function verdict({ pValue, size, conjugateSize }) {
  const left = `The chain of relaxations leaves ${percent(size, 2)} of |Z|`;
  if (conjugateSize < WRONG_SIGN * size) return message("problem", `${left}, but ${percent(conjugateSize, 2)} when the imaginary part changes its sign: the sign was probably mistaken when the file was written or read.`);
  if (pValue == null) return message("", `${left}. The noise of these data is not known well enough to say whether that is too much for an impedance that obeys Kramers–Kronig.`);
  if (pValue < 1e-3) return message("warning", `${left}, more than noise explains (p ${pValue < 1e-4 ? "" : "= "}${probability(pValue)}): the cell drifted, was driven out of its linear range, or the instrument changed. A model of it carries this error.`);
  return message("success", `${left}, no more than noise explains (p = ${probability(pValue)}): the impedance obeys Kramers–Kronig.`);
}
