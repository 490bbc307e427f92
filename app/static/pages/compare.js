// A new comparison, and the earlier ones of this plant.

import { list } from "../js/api.js";
import { experimentChoice } from "../js/compare/experiment_choice.js";
import { ratio } from "../js/compare/lack_of_fit.js";
import { context } from "../js/context.js";
import { byId, h, message, replace } from "../js/dom.js";
import { checkbox, field, fields, select, submitButton } from "../js/forms.js";
import { runJob } from "../js/jobs.js";
import { comparable } from "../js/models/experiments.js";
import { datedTitle, fittedTo, indexed, titleOf } from "../js/models/versions.js";
import { moment, probability, significant } from "../js/numbers.js";
import { showProblem } from "../js/problems.js";
import { page } from "../js/ready.js";
import { plant } from "../js/shell.js";
import { table } from "../js/tables.js";

const at = (rest) => `/plants/${context.plantId}/${rest}`;

page(async () => {
  const query = { plantId: context.plantId };
  const [found, models, experiments, comparisons] = await Promise.all([
    plant, list("/models", query), list("/experiments", query), list("/comparisons", query, 100)]);
  drawForm(found, models, experiments);
  drawEarlier(comparisons, indexed(models));
});

function drawForm(found, models, experiments) {
  const place = byId("form");
  if (!models.length) return replace(place, message("", h("p", {}, "There is no model yet. ", h("a", { href: at("models") }, "Identify one first."))));
  if (!experiments.length) return replace(place, message("", h("p", {}, "There is no experiment to compare with. ", h("a", { href: at("experiments") }, "Bring one in first."))));
  const known = indexed(models);
  const asked = new URLSearchParams(location.search).get("model");
  const model = select(models.map((one) => [one.id, datedTitle(one)]), known.has(asked) ? asked : models[0].id);
  const choices = h("div", {});
  let choice = null;
  const choose = () => {
    const chosen = known.get(model.value);
    const fitted = fittedTo(chosen, known);
    choice = experimentChoice({ legend: "Experiments", experiments: experiments.filter((one) => comparable(one, chosen)), variables: found.schedulingVariables, ticked: () => true,
      notes: (one) => (fitted.has(one.id) ? "fitted" : "held out"), pointer: "/experimentIds", hint: "Experiments that no version of the model was fitted to are the ones that count." });
    replace(choices, choice.element);
  };
  model.addEventListener("change", choose);
  choose();
  const mean = checkbox(true);
  const form = h("form", { novalidate: true, onsubmit: (event) => event.preventDefault() },
    h("div", { class: "narrow" }, field("model", model, { pointer: "/modelId" })), choices,
    field("compare the mean value of periodic records too", mean, { pointer: "/meanValue" }),
    h("p", { class: "actions" }, submitButton("Compare", () => submit(), { type: "submit" })));
  const submit = async () => {
    try {
      const { id } = await runJob("/comparisons", { modelId: model.value, experimentIds: choice.value(), meanValue: mean.checked }, byId("job"));
      location.href = at(`compare/${id}`);
    } catch (problem) {
      showProblem(problem, { place, form });
    }
  };
  return replace(place, form);
}

function drawEarlier(comparisons, models) {
  const place = byId("comparisons");
  if (!comparisons.length) return replace(place, h("p", { class: "hint" }, "There is none yet."));
  const part = (one, data) => one.parts.find((each) => each.data === data)?.lackOfFit ?? null;
  const misfit = (test) => (test ? `${significant(ratio(test))} (p ${probability(test.pValue)})` : "–");
  const rows = comparisons.map((one) => [h("a", { href: at(`compare/${one.id}`) }, moment(one.createdAt)), models.has(one.modelId) ? titleOf(models.get(one.modelId)) : "a model", String(one.experiments.length), misfit(part(one, "fitted")), misfit(part(one, "heldOut"))]);
  return replace(place, table({ caption: "χ² per degree of freedom: 1 where only noise is left", columns: ["comparison", "model", "experiments", "fitted", "held out"], rows, textColumns: 2 }));
}
