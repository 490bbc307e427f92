// "Add this effect": the model is fitted once more with it; the error on held-out experiments says what it brought.

import { get } from "../api.js";
import { h } from "../dom.js";
import { experimentChoice } from "../compare/experiment_choice.js";
import { field, fields, select, textInput } from "../forms.js";
import { runJob } from "../jobs.js";
import { comparable } from "../models/experiments.js";
import { fittedTo, titleOf } from "../models/versions.js";
import { showProblem } from "../problems.js";
import { historyPath } from "./ranking.js";

export class AddEffect {
  // jobPlace: where progress is shown; `panel` holds the choices, folded in.
  constructor(jobPlace, { plant, diagnosis, comparison, model, models, experiments }) {
    Object.assign(this, { jobPlace, diagnosis, model });
    this.judged = [...new Set(diagnosis.visibility.map((one) => one.kind))];
    const variables = plant.schedulingVariables;
    const usable = experiments.filter((one) => comparable(one, model));
    const fitted = new Set([...fittedTo(model, models), ...diagnosis.experimentIds]);
    const compared = comparison ? new Set(comparison.experiments.filter((one) => one.data === "heldOut").map((one) => one.experimentId)) : null;
    const heldOut = (one) => !fitted.has(one.id) && (compared == null || !compared.size || compared.has(one.id));
    this.fit = experimentChoice({ legend: "Fit to", experiments: usable, variables, ticked: (one) => diagnosis.experimentIds.includes(one.id), notes: () => "", pointer: "/experimentIds" });
    this.hold = experimentChoice({ legend: "Held out, for the error before and after", experiments: usable.filter((one) => !fitted.has(one.id)), variables, ticked: heldOut, notes: () => "", pointer: "/heldOutExperimentIds" });
    this.degree = select([[0, "constant"], [1, "affine in the scheduling variable"], [2, "quadratic"], [3, "cubic"]], diagnosis.amplitudeDegree);
    this.name = textInput("");
    this.panel = h("details", { class: "panel" }, h("summary", {}, "What an added effect is fitted to, and what is held out"),
      fields(field("amplitude is", this.degree, { pointer: "/amplitudeDegree" }), field("name of the new version", this.name, { hint: "empty: named after the effect", pointer: "/name" })),
      h("div", { class: "columns" }, this.fit.element, this.hold.element));
  }

  // Start the refit with a ranked effect; goes on to the history when it is done.
  start(ranked, button) {
    return this.#run(`/models/${this.model.id}/extensions`, this.#request(ranked), button, ({ id }) => id);
  }

  // Diagnose and add the best effect, again and again, until noise explains what is left.
  startStaircase(button) {
    const lastOf = async ({ href }) => (await get(href)).steps.at(-1).modelId;
    return this.#run(`/models/${this.model.id}/staircases`, { ...this.#common(), effects: this.judged }, button, lastOf);
  }

  async #run(path, body, button, modelOf) {
    button.disabled = true;
    this.jobPlace.scrollIntoView({ block: "center" });
    try {
      location.href = historyPath(await modelOf(await runJob(path, body, this.jobPlace)));
    } catch (problem) {
      if (!problem.title) throw problem;
      if (problem.errors?.length) this.panel.open = true;
      showProblem(problem, { place: this.jobPlace, form: this.panel });
    } finally {
      button.disabled = false;
    }
  }

  #request(ranked) {
    return {
      ...this.#common(), effect: ranked.kind, quantity: ranked.quantity, diagnosisId: this.diagnosis.id,
      name: this.name.value.trim() || `${titleOf(this.model)} + ${ranked.title}`.slice(-200),
    };
  }

  #common() {
    return { amplitudeDegree: Number(this.degree.value), experimentIds: this.fit.value(), heldOutExperimentIds: this.hold.value(), meanValue: this.diagnosis.meanValue, seed: this.diagnosis.seed };
  }
}
