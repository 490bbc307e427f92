// One model: parameters, response, poles, tests, where it came from.

import { get, list } from "../js/api.js";
import { context } from "../js/context.js";
import { byId, facts, h, message, replace } from "../js/dom.js";
import { operatingPoints } from "../js/models/experiments.js";
import { parameterTable } from "../js/models/parameters.js";
import { polesPlot } from "../js/models/poles.js";
import { provenance } from "../js/models/provenance.js";
import { ResponseView } from "../js/models/response_view.js";
import { datedTitle, effectsText, indexed, lineage, titleOf } from "../js/models/versions.js";
import { counted, probability, significant } from "../js/numbers.js";
import { loadPlotly } from "../js/plots.js";
import { page } from "../js/ready.js";
import { plant } from "../js/shell.js";
import { structureText } from "../js/structure_fields.js";
import { table } from "../js/tables.js";

const at = (rest) => `/plants/${context.plantId}/${rest}`;

loadPlotly(); // while the data come
page(async () => {
  const query = { plantId: context.plantId };
  const [found, model, models, experiments] = await Promise.all([plant, get(`/models/${context.modelId}`), list("/models", query), list("/experiments", query)]);
  byId("title").textContent = titleOf(model);
  document.title = `${titleOf(model)} · ${found.name} · lpv-oed`;
  drawAbout(model, lineage(model, indexed(models)));
  replace(byId("parameters"), parameterTable([["estimate ± standard deviation", model]], found));
  replace(byId("provenance"), provenance(model, { plant: found, models: indexed(models), experiments: indexed(experiments) }));
  drawTests(model);
  drawPoles(model, found);
  await drawResponse(model, found, experiments);
});

function drawAbout(model, line) {
  replace(byId("actions"), h("p", { class: "actions" }, h("a", { class: "button", href: at(`compare?model=${model.id}`) }, "Compare with measurements"),
    h("a", { class: "button quiet", href: at(`history?model=${model.id}`) }, "Versions")));
  replace(byId("about"),
    model.description ? h("p", {}, model.description) : null,
    model.outcome.status === "converged" ? null : message("warning", `${model.outcome.status.replaceAll("_", " ")}: ${model.outcome.advice}`),
    facts([`${line.length}`, "version"], [counted(model.theta.length, "parameter"), structureText(model.structure)], [effectsText(model), "effects"],
      [model.stable ? "stable" : "not stable", "over the range"]),
    model.covariance || model.jointCovariance ? null : message("warning", "The covariance is not known, so that no accuracy can be stated."));
}

function drawTests({ tests }) {
  if (!tests.length) return replace(byId("tests"), h("p", { class: "hint" }, "None were made."));
  const rows = tests.map((one) => [one.name, significant(one.statistic, 4), significant(one.degreesOfFreedom, 4), probability(one.pValue)]);
  return replace(byId("tests"), table({ caption: "A small p-value speaks against the model", columns: ["test", "statistic", "degrees of freedom", "p-value"], rows }));
}

function drawPoles(model, found) {
  const place = byId("poles");
  replace(place);
  if (!model.poles.some((one) => one.poles.re.length)) {
    return replace(place, h("p", { class: "hint" }, found.schedulingVariables.length > 1 ? "Poles are drawn over one scheduling variable only." : "This model has none."));
  }
  return polesPlot(place, model, found.schedulingVariables[0]);
}

function drawResponse(model, found, experiments) {
  const own = experiments.filter((one) => model.experimentIds.includes(one.id));
  const points = operatingPoints(own.length ? own : experiments);
  const middle = found.schedulingVariables.map((one) => (one.minimum + one.maximum) / 2);
  const view = new ResponseView(byId("response"), { plant: found, points: points.length ? points : [middle], experiments: own.length ? own : experiments, models: [[datedTitle(model), model]] });
  return view.show();
}
