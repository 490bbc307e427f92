// Experiments in words, and which of them can be compared with a model.

import { pointLabel } from "../numbers.js";

// What to call an experiment.
export function experimentTitle(experiment, variables) {
  return experiment.name || pointText(experiment.operatingPoint, variables);
}

// What a model can be held against: one input and output at an operating point, for models along p(t) records along it.
export function comparable(experiment, model) {
  if (experiment.kind === "varyingRecord") return model.varying != null;
  const several = model.stateSpace && (model.stateSpace.inputCount > 1 || model.stateSpace.outputCount > 1);
  return ["timeRecord", "frequencyResponse"].includes(experiment.kind) && !several;
}

// An operating point in words, also where it was not held.
export function pointText(operatingPoint, variables) {
  return operatingPoint ? pointLabel(operatingPoint, variables) : "varying";
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
