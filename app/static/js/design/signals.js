// A design made into signals to play, and these to be saved.

import { download, get, list } from "../api.js";
import { h, replace } from "../dom.js";
import { field, fields, integerInput, numberInput, numberOf, select, submitButton } from "../forms.js";
import { runJob } from "../jobs.js";
import { duration, exact, labelled, moment, pointLabel, quantity, significant } from "../numbers.js";
import { showProblem } from "../problems.js";
import { table } from "../tables.js";
import { energyUnit } from "./spectra.js";

export async function drawSignals(place, plant, design) {
  const [signals, examples] = await Promise.all([list("/signals", { plantId: plant.id }, 500), list("/examples")]);
  const example = examples.find((one) => one.plantId === plant.id) ?? null;
  const progress = h("div", {});
  const listed = h("div", {});
  const add = (made) => listed.prepend(h("div", {}, signalTable(made, plant), example && playButton(example, made, progress)));
  signals.filter((one) => one.designId === design.id).reverse().forEach(add);
  replace(place, h("h2", {}, "Signals to play"), form(plant, design, progress, add), progress, listed);
}

function form(plant, design, progress, add) {
  const method = select([["multisine", "multisine: exactly the designed lines"], ["filtered_noise", "noise with the designed spectrum"]], "multisine");
  const [periods, samples, seed, oversampling] = [integerInput(null, { min: 1 }), integerInput(null, { min: 2 }), integerInput(0, { min: 0 }), integerInput(1, { min: 1, max: 16 })];
  const limit = numberInput(null, { min: 0 });
  const element = h("form", { novalidate: true, onsubmit: (event) => event.preventDefault() }, fields(
    field("method", method, { pointer: "/method", wide: true }),
    field("periods", periods, { hint: "two or more show the noise; empty: as many as fit", pointer: "/periods" }),
    field(labelled("largest value", plant.input.unit), limit, { hint: "empty: no limit", pointer: "/amplitudeLimit" }),
    field("samples of one period", samples, { hint: "empty: those of the design", pointer: "/samples" }),
    field("oversampling", oversampling, { hint: "above 1: the peak behind a reconstruction filter", pointer: "/oversampling" }),
    field("seed", seed, { hint: "of phases or noise", pointer: "/seed" })),
  h("p", { class: "actions" }, submitButton("Make signals", () => make(), { type: "submit" })));
  const make = async () => {
    const body = { method: method.value, periods: numberOf(periods), samples: numberOf(samples), amplitudeLimit: numberOf(limit), oversampling: numberOf(oversampling), seed: numberOf(seed) };
    try {
      const { href } = await runJob(`/designs/${design.id}/signals`, body, progress);
      add(await get(href));
    } catch (problem) {
      if (!problem.title) throw problem;
      showProblem(problem, { place: progress, form: element });
    }
  };
  return element;
}

// For a simulated plant: what playing the signals would measure becomes experiments.
function playButton(example, made, progress) {
  const play = async () => {
    try {
      const seed = crypto.getRandomValues(new Uint32Array(1))[0];
      await runJob(`/examples/${example.id}/measurements`, { signalsId: made.id, seed }, progress);
      location.href = `/plants/${example.plantId}/experiments`;
    } catch (problem) {
      if (!problem.title) throw problem;
      showProblem(problem, { place: progress });
    }
  };
  return h("p", { class: "actions" }, submitButton("Play them on the simulated plant", play));
}

function signalTable(made, plant) {
  const save = (one) => h("span", { class: "together" }, ["csv", "npz", "mat", "wav"].map((format) => [submitButton(format, () => download(`/signals/${made.id}/file`, { format, index: one.index }),
    { class: "quiet", "aria-label": `Save the signal at ${pointLabel(one.operatingPoint, plant.schedulingVariables)} as ${format}` }), " "]));
  const rows = made.signals.map((one) => [
    pointLabel(one.operatingPoint, plant.schedulingVariables), save(one), `${one.periods} × ${one.periodSamples}`, duration(one.durationSeconds), exact(one.sampleTimeSeconds, "s"),
    quantity(one.energy, energyUnit(plant), 4), quantity(one.peak, plant.input.unit) + (one.amplitudeLimitBinds ? ", at its limit" : ""), significant(one.crestFactor),
  ]);
  return table({ caption: `${made.request.method === "multisine" ? "Multisines" : "Filtered noise"}, made ${moment(made.createdAt)}`, textColumns: 2, rows,
    columns: ["operating point", "save as", "periods × samples", "duration", "sample time", "energy", "peak", "crest factor"] });
}
