// A model from experiments, with some of them kept back to judge it by.

import { get, list } from "../js/api.js";
import { context } from "../js/context.js";
import { byId, h, message, replace } from "../js/dom.js";
import { checkbox, field, fields, group, select, submitButton, textInput } from "../js/forms.js";
import { estimators } from "../js/identify/estimators.js";
import { override } from "../js/identify/override.js";
import { roles } from "../js/identify/roles.js";
import { runJob } from "../js/jobs.js";
import { moment } from "../js/numbers.js";
import { showProblem } from "../js/problems.js";
import { page } from "../js/ready.js";
import { plant } from "../js/shell.js";

const at = (rest) => `/plants/${context.plantId}/${rest}`;

page(async () => {
  const query = { plantId: context.plantId };
  const [described, catalogue, all, models] = await Promise.all([plant, get("/catalogue"), list("/experiments", query), list("/models", query, 100)]);
  const experiments = all.filter((one) => ["timeRecord", "frequencyResponse"].includes(one.kind));
  if (described.structure.timeDomain.endsWith("StateSpace")) {
    replace(byId("form"), message("", h("p", {}, "Models in state space are identified over ", h("a", { href: "/v1/openapi.json" }, "the interface"), ", with the kind stateSpace of POST /v1/models.")));
  } else if (!experiments.length) {
    replace(byId("form"), message("", h("p", {}, "There is no experiment to fit a model to. ", h("a", { href: at("experiments") }, "Bring one in first."))));
  } else {
    replace(byId("form"), new IdentificationForm(described, catalogue, experiments, models).element);
  }
});

class IdentificationForm {
  constructor(described, catalogue, experiments, models) {
    this.name = textInput();
    this.roles = roles(experiments, described.schedulingVariables, described.output.unit);
    this.estimators = estimators(catalogue, described, experiments);
    this.override = override(catalogue, described);
    this.prior = select([["", "none"], ...models.filter((one) => one.covariance).map((one) => [one.id, `${one.name || one.origin}, ${moment(one.createdAt)}`])], "");
    this.compare = checkbox(true);
    this.element = h("form", { novalidate: true, onsubmit: (event) => event.preventDefault() },
      group("Experiments", this.roles.element),
      group("Estimators", this.estimators.element),
      group("More", fields(
        field("name", this.name, { pointer: "/name" }),
        field("add what a model knows already", this.prior, { hint: "of other experiments; the new one is its next version", pointer: "/priorModelId" })), this.override.element),
      field("then compare it with the experiments that were fitted and those that were held out", this.compare),
      h("p", { class: "actions" }, submitButton("Identify a model", () => this.#submit(), { type: "submit" })));
  }

  async #submit() {
    const fitted = this.roles.of("fitted");
    const body = {
      kind: "rational", plantId: context.plantId, name: this.name.value.trim(), experimentIds: fitted, ...this.estimators.value(), ...this.override.value(),
      priorModelId: this.prior.value || null,
    };
    try {
      const model = await runJob("/models", body, byId("job"));
      location.href = this.compare.checked ? await this.#compared(model.id, fitted) : at(`models/${model.id}`);
    } catch (problem) {
      if (!problem.title) throw problem;
      showProblem(problem, { place: byId("form"), form: this.element });
    }
  }

  // Where the comparison of a new model is; where the model is, when it cannot be compared.
  async #compared(modelId, fitted) {
    try {
      const { id } = await runJob("/comparisons", { modelId, experimentIds: [...fitted, ...this.roles.of("heldOut")] }, byId("job"));
      return at(`compare/${id}`);
    } catch (problem) {
      if (!problem.title) throw problem;
      return at(`models/${modelId}`);
    }
  }
}
