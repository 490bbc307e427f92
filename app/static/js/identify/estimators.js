// How a model is found, with choices that suit the plant and the data.

import { h } from "../dom.js";
import { pluginField } from "../plugin_field.js";

// {element, value()}: the estimators of a request.
export function estimators(catalogue, plant, experiments) {
  const responses = experiments.some((one) => one.kind === "frequencyResponse");
  const continuous = plant.structure.timeDomain !== "discrete";
  const fits = continuous || responses;
  const local = pluginField("model of one operating point", catalogue.localEstimators, { pointer: "/localEstimator", kind: fits ? "rational_fit" : "prediction_error" });
  const lpv = pluginField("model over the range", catalogue.lpvEstimators, { pointer: "/lpvEstimator", kind: "joint_likelihood" });
  const periodic = experiments.every((one) => one.kind !== "timeRecord" || one.understood.periods >= 2);
  const spectral = pluginField("frequency responses of records", catalogue.spectralEstimators, {
    pointer: "/spectralEstimator", none: "none: fit to the records themselves", kind: fits && experiments.some((one) => one.kind === "timeRecord") ? (periodic ? "periodic_average" : "local_polynomial") : "",
  });
  return {
    element: h("div", { class: "columns" }, spectral.element, local.element, lpv.element),
    value: () => ({ spectralEstimator: spectral.value(), localEstimator: local.value(), lpvEstimator: lpv.value() }),
  };
}
