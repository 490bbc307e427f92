// The errors of the versions of a model as a staircase, on fitted and on held-out data.

import { logAxis } from "../log_axis.js";
import { percent, probability, significant } from "../numbers.js";
import { dash, seriesColour } from "../palette.js";
import { axis, plot } from "../plots.js";

// The steps of a line of versions: [{model, label, fitted, heldOut, lackOfFit}], from the first version that has errors.
// A model that was extended has its errors in the report of the extension, fitted to the same data.
export function stepsOf(line) {
  return line.flatMap((model, i) => {
    const before = line[i + 1]?.extension?.before;
    const found = model.extension?.after ?? before;
    return found ? [{ model, label: i === 0 || !model.extension ? "as it was" : `+ ${model.effects.at(-1).title}`, fitted: found.fitted, heldOut: found.heldOut, lackOfFit: found.lackOfFit }] : [];
  });
}

export function staircasePlot(place, steps) {
  const curves = [["fitted", (one) => one.fitted], ["held out", (one) => one.heldOut]].map(([name, valueOf]) => ({ name, values: steps.map(valueOf) })).filter((one) => one.values.some((value) => value != null));
  const places = steps.map((_, i) => i);
  return plot(place, {
    caption: "Relative error ‖Y − Ŷ‖/‖Y‖ of each version at the excited lines.", height: 340,
    draw: () => ({ data: curves.flatMap((curve, i) => [stair(curve, places, i), labels(curve, places, i, curves.length)]), layout: layout(steps, curves) }),
    table: () => ({ columns: ["version", "error, fitted", "error, held out", "p-value of the lack of fit"], rows: steps.map((one) => [one.label, percent(one.fitted), one.heldOut == null ? "–" : percent(one.heldOut), probability(one.lackOfFit.pValue)]) }),
  });
}

function stair({ name, values }, places, i) {
  const line = { shape: "hv", color: seriesColour(i), dash: dash(i), width: 3 };
  return { x: [...places, places.length], y: [...values, values.at(-1)].map(inPercent), mode: "lines", name, line, connectgaps: false };
}

function labels({ values }, places, i, count) {
  const offset = count > 1 ? 0.3 + 0.4 * i : 0.5;
  return { x: places.map((place) => place + offset), y: values.map((value) => inPercent(value) * 1.02), text: values.map((value) => (value == null ? "" : percent(value))), mode: "text", textposition: "top center", cliponaxis: false, showlegend: false, hoverinfo: "skip", textfont: { color: seriesColour(i) } };
}

const inPercent = (value) => (value == null ? null : 100 * value);

function layout(steps, curves) {
  const errors = curves.flatMap((one) => one.values).filter((value) => value != null && value > 0).map((value) => Math.log10(100 * value));
  const [low, high] = [Math.min(...errors), Math.max(...errors)];
  const edge = Math.max(0.12 * (high - low), 0.08);
  return {
    xaxis: axis("", { tickvals: steps.map((_, i) => i + 0.5), ticktext: steps.map((one) => one.label), showgrid: false, range: [-0.05, steps.length + 0.05] }),
    yaxis: logAxis("relative error (%)", [10 ** low, 10 ** (high + edge)], { range: [low - edge, high + 2 * edge] }),
  };
}

// What the last step of a model brought, in words: {kind of message, text}.
export function broughtText(model) {
  const { before, after } = model.extension;
  const heldOut = before.heldOut != null && after.heldOut != null;
  const [from, to] = heldOut ? [before.heldOut, after.heldOut] : [before.fitted, after.fitted];
  const what = heldOut ? "on the held-out experiments" : "on the fitted experiments (none were held out)";
  const fitted = heldOut ? ` On the fitted ones: ${percent(before.fitted)} → ${percent(after.fitted)}.` : "";
  const fallen = to < from;
  const times = fallen ? `, ${significant(from / to, 2)} times less` : "";
  return { kind: fallen ? "success" : "warning", text: `${fallen ? "The error has fallen" : "The error has not fallen"} ${what}: ${percent(from)} → ${percent(to)}${times}.${fitted}`, effect: model.effects.at(-1) };
}

// What all steps together brought.
export function sinceText(steps) {
  const held = steps.every((one) => one.heldOut != null);
  const [from, to] = [steps[0], steps.at(-1)].map((one) => (held ? one.heldOut : one.fitted));
  return `Since the first version: ${percent(from)} → ${percent(to)}.`;
}
