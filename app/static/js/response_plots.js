// Frequency responses as gain and phase, with their standard deviations.

import { hertz, labelled, significant } from "./numbers.js";
import { axis, linkAxes, plot } from "./plots.js";
import { faded, seriesColour, symbol } from "./palette.js";

const SURE = 0.35; // standard deviation over size of a value whose phase is known
const REMEMBERED = 3;

// Gain and phase of a measured response, of every channel where there are several.
export function drawResponse(place, plant, data) {
  const frequencies = data.frequenciesRadPerSecond.map(hertz);
  const curves = channels(data, plant).map((one) => ({ ...one, gain: gains(one), phase: unwrapped(one) }));
  const log = frequencies.some((one) => one > 0) && Math.max(...frequencies) / Math.min(...frequencies.filter((one) => one > 0)) > 20;
  const traces = (values, deviations, least) => curves.flatMap((one, i) => [
    deviations(one) ? band(frequencies, values(one), deviations(one), i, least) : null,
    { x: frequencies, y: values(one), name: one.name, mode: "markers", marker: { size: 5, symbol: symbol(i), color: seriesColour(i) } },
  ].filter(Boolean));
  const table = () => ({ columns: ["frequency (Hz)", ...curves.flatMap((one) => [`gain ${one.name}`, `phase (°) ${one.name}`])],
    rows: frequencies.map((value, i) => [significant(value, 4), ...curves.flatMap((one) => [significant(one.gain[i], 4), significant(one.phase[i], 4)])]) });
  const unit = plant.input ? [plant.output.unit, plant.input.unit].filter(Boolean).join("/") : "";
  const gain = plot(place, {
    caption: `Gain${data.variance ? " with one standard deviation" : ""}.`, height: 300, table,
    draw: () => ({ data: traces((one) => one.gain, (one) => one.deviation, (gain) => gain / 100), layout: { xaxis: axis("frequency (Hz)", { log }), yaxis: axis(labelled("gain", unit), { log: true }), showlegend: curves.length > 1 } }),
  });
  const phase = plot(place, {
    caption: "Phase.", height: 260, table,
    draw: () => ({ data: traces((one) => one.phase, (one) => one.deviation?.map((value, i) => (180 / Math.PI) * Math.min(value / one.gain[i], 1)), () => -Infinity), layout: { xaxis: axis("frequency (Hz)", { log }), yaxis: axis("phase (°)"), showlegend: false } }),
  });
  linkAxes([gain, phase]);
}

// One standard deviation to both sides, as an area that stays above the `least` of each value.
function band(frequencies, values, deviations, i, least) {
  const order = frequencies.map((_, k) => k).sort((a, b) => frequencies[a] - frequencies[b]);
  const back = [...order].reverse();
  return {
    x: [...order, ...back].map((k) => frequencies[k]),
    y: [...order.map((k) => values[k] + deviations[k]), ...back.map((k) => Math.max(values[k] - deviations[k], least(values[k])))],
    fill: "toself", fillcolor: faded(seriesColour(i), 0.3), line: { width: 0 }, mode: "lines", hoverinfo: "skip", showlegend: false,
  };
}

function channels({ kind, response: { re, im }, variance }, plant) {
  const deviation = (values) => values?.map((one) => Math.sqrt(one / 2));
  if (kind === "frequencyResponse") return [{ name: "", re, im, deviation: deviation(variance) }];
  const at = (matrices, i, j) => matrices?.map((matrix) => matrix[i][j]);
  return re[0].flatMap((row, i) => row.map((_, j) => ({
    name: `${plant.outputs?.[i].name ?? "output"} / ${plant.inputs?.[j].name ?? "input"}`,
    re: at(re, i, j), im: at(im, i, j), deviation: deviation(at(variance, i, j)),
  })));
}

export function gains({ re, im }) {
  return re.map((real, i) => Math.hypot(real, im[i]));
}

// Phase in degrees without jumps: each stands within half a turn of those before it that are no noise.
export function unwrapped({ re, im, deviation = null }) {
  const recent = [];
  return re.map((real, i) => {
    const angle = (180 / Math.PI) * Math.atan2(im[i], real);
    const expected = recent.length ? [...recent].sort((a, b) => a - b)[recent.length >> 1] : angle > 170 ? -180 : angle;
    const near = angle + 360 * Math.round((expected - angle) / 360);
    if (!(deviation?.[i] > SURE * Math.hypot(real, im[i]))) recent.push(near);
    if (recent.length > REMEMBERED) recent.shift();
    return near;
  });
}
