// Experiments in words, and which of them can be compared with a model.

import { pointLabel } from "../numbers.js";

// What to call an experiment.
export function experimentTitle(experiment, variables) {
  const point = experiment.operatingPoint ? pointLabel(experiment.operatingPoint, variables) : "varying";
  return experiment.name || point;
}

// One input, one output, and an operating point that was held.
export function comparable(experiment) {
  return ["timeRecord", "frequencyResponse"].includes(experiment.kind) && experiment.operatingPoint !== null;
}

// By operating point, then in the order in which they came in.
export function sorted(experiments) {
  return [...experiments].sort((a, b) => byPoint(a.operatingPoint, b.operatingPoint) || a.id.localeCompare(b.id));
}

export function byPoint(a, b) {
  for (let i = 0; i < Math.min(a?.length ?? 0, b?.length ?? 0); i += 1) if (a[i] !== b[i]) return a[i] - b[i];
  return 0;
}

// Operating points, each once, in order.
export function operatingPoints(experiments) {
  const held = experiments.filter((one) => one.operatingPoint);
  const found = new Map(held.map((one) => [JSON.stringify(one.operatingPoint), one.operatingPoint]));
  return [...found.values()].sort(byPoint);
}
