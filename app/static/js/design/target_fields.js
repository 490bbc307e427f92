// Accuracy targets in the user's terms; each kind of target that has words of its own here, the others by their options.

import { h } from "../dom.js";
import { field, fields, integerInput, numberInput, numberOf, textInput } from "../forms.js";
import { hertz, labelled, quantity, radPerSecond, significant } from "../numbers.js";
import { pluginField, words } from "../plugin_field.js";
import { coefficientNames } from "../structure_fields.js";
import { detectionFields, discriminationFields } from "./effect_targets.js";
import { combinations, pointsIn, spread } from "./grids.js";

const QUANTILE_95 = 1.96; // a normal quantity lies within so many standard deviations with 95 % probability

// By kind: (plant, pointer, catalogue, catalogue entry) to {element, value()}.
const FIELDS = {
  response_deviation: responseFields, parameter_deviation: parameterFields, local_covariance: coefficientFields,
  effect_detection: detectionFields, effect_discrimination: discriminationFields,
};
const TITLES = {
  response_deviation: "the frequency response, in per cent", parameter_deviation: "the parameters", local_covariance: "the coefficients at chosen operating points",
  effect_detection: "whether a physical effect is there", effect_discrimination: "which of two effects is there",
};

export const targetTitle = (kind) => TITLES[kind] ?? kind.replaceAll("_", " ");

export function targetFields(entry, plant, catalogue, pointer) {
  return (FIELDS[entry.kind] ?? otherFields)(plant, pointer, catalogue, entry);
}

function responseFields(plant, pointer) {
  const share = numberInput(1, { min: 0 });
  const [low, high] = usualBand(plant.structure).map((value) => numberInput(Number(value.toPrecision(2)), { min: 0 }));
  const count = integerInput(plant.schedulingVariables.length > 1 ? 4 : 9, { min: 1 });
  const names = plant.schedulingVariables.map((one) => one.name).join(" and ");
  const element = fields(
    field("within (± %)", share, { hint: "of the gain, with 95 % probability", pointer: `${pointer}/standardDeviation` }),
    field("from (Hz)", low, { pointer: `${pointer}/minimumRadPerSecond` }),
    field("to (Hz)", high, { pointer: `${pointer}/maximumRadPerSecond` }),
    field(`at values of ${names}`, count, { hint: "spread evenly over the range", pointer: `${pointer}/operatingPoints` }));
  const inRad = (input) => (numberOf(input) == null ? null : radPerSecond(numberOf(input)));
  const value = () => ({
    kind: "response_deviation", relative: true, standardDeviation: numberOf(share) == null ? null : numberOf(share) / 100 / QUANTILE_95,
    minimumRadPerSecond: inRad(low), maximumRadPerSecond: inRad(high),
    operatingPoints: combinations(plant.schedulingVariables.map((one) => spread(one, Math.min(Math.max(numberOf(count) ?? 1, 1), 1000)))),
  });
  return { element, value };
}

// A band to begin with, in Hz: about the frequency scale, or up to half the Nyquist frequency.
export function usualBand({ sampleTimeSeconds, frequencyScaleRadPerSecond }) {
  const middle = sampleTimeSeconds ? 0.05 / sampleTimeSeconds : hertz(frequencyScaleRadPerSecond);
  return [middle / 5, 3 * middle];
}

function parameterFields(plant, pointer) {
  const inputs = plant.parameterNames.map((name, i) => [name, numberInput(null, { min: 0 }), i]);
  const element = h("div", { "data-pointer": `${pointer}/standardDeviations` },
    h("p", { class: "hint" }, "Largest standard deviation of each parameter; empty: not asked for."),
    fields(inputs.map(([name, input, i]) => field(name, input, { pointer: `${pointer}/standardDeviations/${i}` }))));
  return { element, value: () => ({ kind: "parameter_deviation", standardDeviations: inputs.map(([, input]) => numberOf(input)) }) };
}

function coefficientFields(plant, pointer) {
  const coefficients = plantCoefficients(coefficientNames(plant.structure));
  const inputs = coefficients.map((name) => [name, numberInput(null, { min: 0 })]);
  const points = textInput("", { placeholder: "separated by semicolons" });
  const names = plant.schedulingVariables.map((one) => labelled(one.name, one.unit)).join(", ");
  const element = h("div", { "data-pointer": pointer },
    fields(field(`at ${names}`, points, { pointer: `${pointer}/operatingPoints`, wide: true })),
    h("p", { class: "hint" }, "Largest standard deviation of each coefficient there."),
    h("div", { "data-pointer": `${pointer}/covariance` }, fields(inputs.map(([name, input]) => field(name, input)))));
  const variance = (input) => (numberOf(input) == null ? null : numberOf(input) ** 2);
  const value = () => ({
    kind: "local_covariance", operatingPoints: pointsIn(points.value, plant.schedulingVariables.length),
    covariance: inputs.map(([, input], i) => inputs.map((_, j) => (i === j ? variance(input) : 0))),
  });
  return { element, value };
}

function otherFields(plant, pointer, catalogue, entry) {
  return pluginField("kind", [entry], { pointer });
}

// Which coefficients of the plant belong to its response; those of the noise do not.
const plantCoefficients = (names) => names.filter((name) => /^(a|b)\d|^tau/.test(name));

// A target in words.
export function targetText(target, plant) {
  if (target.kind === "response_deviation") {
    const within = target.relative ? `${significant(100 * QUANTILE_95 * target.standardDeviation)} %` : significant(QUANTILE_95 * target.standardDeviation);
    const band = `${significant(hertz(target.minimumRadPerSecond))} to ${quantity(hertz(target.maximumRadPerSecond), "Hz")}`;
    return `response within ± ${within} (95 %) from ${band} at ${target.operatingPoints.length} operating points`;
  }
  if (target.kind === "parameter_deviation") {
    const each = target.standardDeviations.flatMap((value, i) => (value == null ? [] : [`${plant.parameterNames[i]} ${significant(value)}`]));
    return `standard deviations: ${each.join(", ")}`;
  }
  if (target.kind === "local_covariance") return `covariance of the coefficients at ${target.operatingPoints.length} operating points`;
  const rates = `with ${significant(100 * target.power)} % power at a level of ${significant(100 * target.level)} %`;
  if (target.kind === "effect_detection") return `see ${words(target.effect)} of size ${significant(target.amplitude)} ${rates}`;
  if (target.kind === "effect_discrimination") return `tell ${words(target.effect)} from ${words(target.against)} ${rates}`;
  return targetTitle(target.kind);
}

