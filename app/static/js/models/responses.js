// Frequency responses of models, over the band that was measured.

import { get } from "../api.js";

const COUNT = 300;

// Lowest and highest frequency to draw a model over, in rad/s; without experiments what its structure is made for.
export function bandOf(model, experiments) {
  const lowest = Math.min(...experiments.map((one) => one.understood.minimumFrequencyRadPerSecond ?? Infinity));
  const highest = Math.max(...experiments.map((one) => one.understood.maximumFrequencyRadPerSecond ?? 0));
  const top = limitOf(model);
  if (highest > 0) {
    const low = lowest > 0 && lowest < highest ? lowest : highest / 1000;
    return [low / 1.3, Math.min(highest * 1.3, top)];
  }
  if (Number.isFinite(top)) return [top / 1000, top];
  const scale = model.structure.frequencyScaleRadPerSecond ?? 1;
  return [scale / 100, scale * 100];
}

// The response of a model at an operating point over a band in rad/s.
export function responseOf(model, operatingPoint, [minimumRadPerSecond, maximumRadPerSecond]) {
  const query = { operatingPoint, minimumRadPerSecond, maximumRadPerSecond, count: COUNT };
  return get(`/models/${model.id}/frequency-response`, query);
}

function limitOf(model) {
  const step = model.structure.sampleTimeSeconds;
  return step ? Math.PI / step : Infinity;
}
