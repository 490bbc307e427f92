// What a design may use: kind of spectra, samples, band, energy.

import { h } from "../dom.js";
import { field, fields, integerInput, numberInput, numberOf, select, textInput } from "../forms.js";
import { labelled, radPerSecond } from "../numbers.js";
import { pluginField } from "../plugin_field.js";
import { plantLimits } from "./plant_limits.js";
import { usualBand } from "./target_fields.js";

// {element, value()}: these fields of a request.
export function limits(catalogue, plant, experiments) {
  const continuous = plant.structure.timeDomain !== "discrete";
  const family = pluginField("kind of spectra", catalogue.spectrumFamilies, { pointer: "/spectrumFamily", kind: "lines", values: { fir: { degree: 10 }, lines: { samples: 500 } } });
  const others = plantLimits(catalogue);
  const name = textInput();
  const samples = integerInput(1000, { min: 1 });
  const step = numberInput(continuous ? Number((0.05 / usualBand(plant.structure)[1]).toPrecision(2)) : null, { min: 0 });
  const [low, high, cap, tolerance] = [numberInput(null, { min: 0 }), numberInput(null, { min: 0 }), numberInput(null, { min: 0 }), numberInput(1e-4, { min: 0 })];
  const measured = experiments.filter((one) => ["timeRecord", "frequencyResponse"].includes(one.kind)).map((one) => one.id);
  const prior = select([["", "nothing"], ["model", "the accuracy of the model"], ...(measured.length ? [["experiments", `all ${measured.length} experiments so far`]] : [])], "");
  const energy = labelled("most energy at one point", plant.input.unit && `${plant.input.unit}²`);
  const element = h("div", {}, fields(
    field("samples of each experiment", samples, { hint: "more when the noise model needs them", pointer: "/samples" }),
    continuous ? field("sample time (s)", step, { hint: "of the input to be played", pointer: "/sampleTimeSeconds" }) : null,
    field("lowest frequency (Hz)", low, { hint: "empty: all may be excited", pointer: "/band/minimumRadPerSecond" }),
    field("highest frequency (Hz)", high, { pointer: "/band/maximumRadPerSecond" }),
    field(energy, cap, { hint: "Σu²; empty: no limit", pointer: "/energyCaps" }),
    field("relative gap", tolerance, { hint: "that is certified at most", pointer: "/tolerance" }),
    field("name", name, { pointer: "/name" }),
    field("count as known", prior, { hint: "only what is missing is designed", pointer: "/usePriorInformation", wide: true })), family.element, others.element);
  const value = () => ({
    name: name.value.trim(), samples: numberOf(samples), sampleTimeSeconds: continuous ? numberOf(step) : null, spectrumFamily: family.value(),
    band: band(numberOf(low), numberOf(high)), limits: others.value(), energyCaps: numberOf(cap) == null ? null : { default: numberOf(cap) },
    usePriorInformation: prior.value === "model", priorExperimentIds: prior.value === "experiments" ? measured : null, tolerance: numberOf(tolerance),
  });
  return { element, value };
}

function band(low, high) {
  if (low == null && high == null) return null;
  return { minimumRadPerSecond: radPerSecond(low ?? 0), maximumRadPerSecond: high == null ? null : radPerSecond(high) };
}
