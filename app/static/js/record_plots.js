// A record over time, and its spectrum with noise level and excited lines.

import { hertz, labelled, quantity, significant } from "./numbers.js";
import { faded } from "./palette.js";
import { axis, linkAxes, plot, thinned } from "./plots.js";
import { colour } from "./theme.js";

const TABLE_ROWS = 500;

// Input, output (and scheduling) over time, one plot each with a common time axis.
export function drawRecord(place, plant, inputs, outputs, sampleTime, period, scheduling = []) {
  const groups = [
    ...named(inputs, plant.inputs ?? [plant.input]), ...named(outputs, plant.outputs ?? [plant.output]), ...named(scheduling, plant.schedulingVariables),
  ];
  linkAxes(groups.map(({ values, signal }) => {
    const time = values.map((_, index) => index * sampleTime);
    const { x, y } = thinned(time, values);
    return plot(place, {
      caption: `${signal.name} over time${period ? `; a period lasts ${quantity(period * sampleTime, "s")}` : ""}.`,
      height: 230,
      draw: () => ({
        data: [{ x, y, mode: "lines", line: { width: 1.2, color: colour("--series-1") } }],
        layout: { xaxis: axis("time (s)"), yaxis: axis(labelled(signal.name, signal.unit)), shapes: boundaries(period, sampleTime, values.length) },
      }),
      table: () => ({ columns: ["time (s)", labelled(signal.name, signal.unit)], rows: values.slice(0, TABLE_ROWS + 1).map((value, i) => [significant(time[i], 5), significant(value, 5)]) }),
    });
  }));
}

const named = (channels, signals) => channels.map((values, index) => ({ values, signal: signals[index] ?? { name: `channel ${index + 1}`, unit: "" } }));

// A line at the end of each period, when there are not too many.
function boundaries(period, sampleTime, samples) {
  const count = period ? Math.floor(samples / period) : 0;
  if (count < 2 || count > 20) return [];
  return Array.from({ length: count - 1 }, (_, i) => ({
    type: "line", yref: "paper", y0: 0, y1: 1, x0: (i + 1) * period * sampleTime, x1: (i + 1) * period * sampleTime,
    line: { color: colour("--edge"), width: 1, dash: "dot" },
  }));
}

// Amplitudes of input and output over frequency.
export function drawSpectrum(place, plant, spectrum) {
  const frequencies = spectrum.frequenciesRadPerSecond.map(hertz);
  const first = frequencies.find((one) => one > 0);
  const log = frequencies.length > 1 && frequencies.at(-1) / first > 30;
  const title = axis("frequency (Hz)", { log });
  const excited = (values) => pick(frequencies, values, spectrum.excited);
  const others = (values) => pick(frequencies, values, spectrum.excited.map((one) => !one));
  const mean = spectrum.periods > 1 ? ` of the mean over ${spectrum.periods} periods` : "";
  const input = plot(place, {
    caption: `Spectrum of the ${plant.input.name}: amplitude of each line${mean}. Excited lines are filled.`, height: 260,
    draw: () => ({ data: [lines(excited(spectrum.input), "excited", 1, true), lines(others(spectrum.input), "not excited", 6, false)], layout: { xaxis: title, yaxis: amplitude(plant.input) } }),
    table: () => numbers(plant, frequencies, spectrum),
  });
  const output = plot(place, {
    caption: spectrum.noise
      ? `Spectrum of the ${plant.output.name}${mean}, with the standard deviation of the noise in it.`
      : `Spectrum of the ${plant.output.name}. The noise is not known: it takes two periods or more to see it.`,
    height: 300,
    draw: () => ({ data: [lines(excited(spectrum.output), "excited", 1, true), lines(others(spectrum.output), "not excited", 6, false), ...noise(frequencies, spectrum)], layout: { xaxis: title, yaxis: amplitude(plant.output) } }),
    table: () => numbers(plant, frequencies, spectrum),
  });
  linkAxes([input, output]);
}

const amplitude = (signal) => axis(labelled(`amplitude of ${signal.name}`, signal.unit), { log: true });

function pick(frequencies, values, which) {
  const rounding = 1e-10 * Math.max(...values);
  const places = frequencies.map((_, index) => index).filter((index) => which[index] && values[index] > rounding && frequencies[index] > 0);
  return { x: places.map((index) => frequencies[index]), y: places.map((index) => values[index]) };
}

function lines({ x, y }, name, series, filled) {
  const hue = colour(`--series-${series}`);
  return { x, y, name, mode: "markers", marker: { size: filled ? 6 : 4, symbol: filled ? "circle" : "circle-open", color: filled ? hue : faded(hue, 0.6) } };
}

function noise(frequencies, spectrum) {
  if (!spectrum.noise) return [];
  const shown = pick(frequencies, spectrum.noise, frequencies.map(() => true));
  return [{ ...thinned(shown.x, shown.y, 2000), name: "noise", mode: "lines", line: { color: colour("--series-2"), width: 1.5, dash: "dot" } }];
}

function numbers(plant, frequencies, spectrum) {
  const columns = ["frequency (Hz)", labelled(plant.input.name, plant.input.unit), labelled(plant.output.name, plant.output.unit), "noise", "excited"];
  const rows = frequencies.map((one, i) => [significant(one, 4), significant(spectrum.input[i]), significant(spectrum.output[i]), significant(spectrum.noise?.[i], 2), spectrum.excited[i] ? "yes" : "no"]);
  return { columns, rows, caption: "Amplitudes of the lines" };
}
