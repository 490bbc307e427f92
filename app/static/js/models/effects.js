// Effects of models in words: amplitudes with their standard deviations, in the units of the plant.

import { estimate, quantity } from "../numbers.js";

// The unit of an amplitude with the units of the plant in it.
export function unitText(unit, plant) {
  const named = (text, words, signal) => (signal?.unit ? text.replaceAll(words, signal.unit) : text);
  return named(named(unit, "input unit", plant.input), "output unit", plant.output).replace(/^1(?=$| \(| per )/, "").trim();
}

// e of an effect: one number, or one for each power of the scheduling variable.
export function amplitudeText(effect, plant) {
  const unit = unitText(effect.unit, plant);
  const values = effect.coefficients.flat();
  const deviations = effect.standardDeviations?.flat() ?? values.map(() => null);
  const texts = values.map((value, i) => estimate(value, deviations[i] ?? 0, values.length > 1 ? "" : unit));
  return values.length > 1 ? `${texts.join(", ")} ${unit}`.trim() : texts[0];
}

// Its further parameters.
export function parametersText(parameters) {
  return parameters.map((one) => `${one.name.replaceAll("_", " ")} ${one.standardDeviation ? estimate(one.value, one.standardDeviation) : quantity(one.value, "")}`).join(", ");
}

// Amplitude and parameters together.
export function effectText(effect, plant) {
  return [amplitudeText(effect, plant), parametersText(effect.parameters)].filter(Boolean).join("; ");
}
