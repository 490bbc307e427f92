// One experiment: what was understood of it, the record or response, its spectrum.

import { download, get } from "../js/api.js";
import { context } from "../js/context.js";
import { byId, facts, h, message, replace } from "../js/dom.js";
import { submitButton } from "../js/forms.js";
import { drawMeasured } from "../js/measured_plots.js";
import { counted, duration, exact, hertz, moment, percent, pointLabel, quantity, significant } from "../js/numbers.js";
import { loadPlotly } from "../js/plots.js";
import { page } from "../js/ready.js";
import { drawRecord, drawSpectrum } from "../js/record_plots.js";
import { drawResponse } from "../js/response_plots.js";
import { plant } from "../js/shell.js";

loadPlotly(); // while the data come
page(async () => {
  const path = `/experiments/${context.experimentId}`;
  const [described, experiment] = await Promise.all([plant, get(path)]);
  byId("title").textContent = experiment.name || experiment.fileName || "Experiment";
  replace(byId("about"), about(experiment, described));
  const place = byId("plots");
  if (experiment.kind === "timeRecord") {
    const [data, spectrum, response] = await Promise.all([get(`${path}/data`), get(`${path}/spectrum`), get(`${path}/frequency-response`).catch((problem) => problem)]);
    if (response.frequenciesRadPerSecond) drawMeasured(place, described, response);
    else place.append(message("warning", (response.errors?.[0] ?? response).detail));
    place.append(h("h2", {}, "Record"));
    drawRecord(place, described, [data.input], [data.output], data.sampleTimeSeconds, experiment.understood.periodSamples);
    drawSpectrum(place, described, spectrum);
  } else if (experiment.kind === "frequencyResponse") {
    drawMeasured(place, described, await get(`${path}/frequency-response`));
  } else {
    drawOther(place, described, await get(`${path}/data`));
  }
});

function drawOther(place, described, data) {
  if (data.kind === "varyingRecord") return drawRecord(place, described, data.inputs, data.outputs, data.sampleTimeSeconds, null, data.scheduling);
  return drawResponse(place, described, data);
}

function about(experiment, described) {
  const { understood: seen } = experiment;
  const unit = (described.output ?? described.outputs[0]).unit;
  const inHertz = (value) => (value == null ? null : quantity(hertz(value), "Hz"));
  const band = seen.minimumFrequencyRadPerSecond == null ? null : `${inHertz(seen.minimumFrequencyRadPerSecond)} to ${inHertz(seen.maximumFrequencyRadPerSecond)}`;
  const point = experiment.operatingPoint ? pointLabel(experiment.operatingPoint, described.schedulingVariables) : "varies";
  const record = seen.samples != null;
  return [
    facts([point, "operating point"],
      record && [`${counted(seen.samples, "sample")}, ${duration(seen.durationSeconds)}`, `every ${exact(experiment.sampleTimeSeconds, "s")}`],
      record && [periods(seen), seen.periodDetected ? "found by repetition" : "period"],
      [String(seen.frequencyCount), record ? "excited lines" : "frequencies"],
      band && [band, "band"],
      record && [quantity(seen.noiseLevel, unit, 2), "noise level (standard deviation of the output)"],
      seen.signalToNoiseDecibel != null && [quantity(seen.signalToNoiseDecibel, "dB"), "signal to noise"],
      seen.relativeDeviation != null && [percent(seen.relativeDeviation, 2), "median deviation of the response"],
      seen.saturatedFraction ? [percent(seen.saturatedFraction, 2), "of the output at its extremes"] : null),
    seen.warnings.map((text) => message("warning", text)),
    (experiment.loggedQuantities ?? []).length ? h("p", {}, "Logged: ", experiment.loggedQuantities.map((one) => `${one.name} = ${quantity(one.value, one.unit)}`).join(", ")) : null,
    h("p", { class: "hint" }, `Brought in ${moment(experiment.createdAt)} as ${experiment.fileName ?? experiment.source}${offsets(seen, described)}.`),
    h("p", { class: "actions" }, ["csv", "npz", "mat"].map((format) =>
      submitButton(`Save as ${format}`, () => download(`/experiments/${experiment.id}/file`, { format }), { class: "quiet" }))),
  ];
}

function periods(seen) {
  if (seen.periodSamples == null) return "none";
  const transient = seen.transientPeriods ? `, the first ${seen.transientPeriods} not steady` : "";
  return `${seen.periods} × ${seen.periodSamples} samples${transient}`;
}

function offsets(seen, described) {
  if (seen.inputOffset == null || !described.input) return "";
  const mean = (value, unit) => quantity(Math.abs(value) < 1e-12 ? 0 : value, unit);
  return `; mean input ${mean(seen.inputOffset, described.input.unit)}, mean output ${mean(seen.outputOffset, described.output.unit)}`
    + (seen.outputTrend == null ? "" : `, drift ${significant(seen.outputTrend)}`);
}
