// One comparison: the maps, what was measured at a chosen cell, the tests.

import { get, list } from "../js/api.js";
import { CellView } from "../js/compare/cell_view.js";
import { distributionPlot } from "../js/compare/distribution.js";
import { disturbanceTable, misfitPlots, overallTable } from "../js/compare/lack_of_fit.js";
import { DATA, ResidualMaps } from "../js/compare/residual_maps.js";
import { timeResidualPlot } from "../js/compare/time_residuals.js";
import { comparisonVerdict } from "../js/compare/verdict.js";
import { context } from "../js/context.js";
import { byId, h, message, replace } from "../js/dom.js";
import { submitButton } from "../js/forms.js";
import { runJob } from "../js/jobs.js";
import { experimentTitle, pointText } from "../js/models/experiments.js";
import { indexed, titleOf } from "../js/models/versions.js";
import { moment, significant } from "../js/numbers.js";
import { showProblem } from "../js/problems.js";
import { page } from "../js/ready.js";
import { plant } from "../js/shell.js";
import { table } from "../js/tables.js";

const at = (rest) => `/plants/${context.plantId}/${rest}`;

page(async () => {
  const compared = get(`/comparisons/${context.comparisonId}`);
  const [found, comparison, model, { rows, timeRows }, experiments] = await Promise.all([
    plant, compared, compared.then((one) => get(`/models/${one.modelId}`)), get(`/comparisons/${context.comparisonId}/maps`), list("/experiments", { plantId: context.plantId })]);
  const known = indexed(experiments);
  drawVerdict(comparison, model);
  const titles = new Map(experiments.map((one) => [one.id, experimentTitle(one, found.schedulingVariables)]));
  const view = new CellView(byId("cell"), { plant: found, model, comparison, experiments: known });
  const maps = new ResidualMaps(byId("maps"), rows, { variables: found.schedulingVariables, titles, onChoose: (cell) => view.show(cell) });
  const worst = maps.worst();
  if (worst) maps.choose(worst);
  drawTests(comparison, titles, found);
  drawExperiments(comparison, titles, found.schedulingVariables);
  misfitPlots(byId("misfit"), comparison.parts, found.schedulingVariables);
  if (rows.length) distributionPlot(byId("misfit"), maps.parts);
  for (const row of timeRows) timeResidualPlot(byId("misfit"), row, titles.get(row.experimentId) ?? "experiment");
  await view.drawn;
});

function drawVerdict(comparison, model) {
  const diagnose = async (button) => {
    try {
      const { id } = await runJob("/diagnoses", { comparisonId: comparison.id }, byId("job"));
      location.href = at(`diagnose/${id}`);
    } catch (problem) {
      button.disabled = false;
      showProblem(problem, { place: byId("job") });
    }
  };
  const { kind, text } = comparisonVerdict(comparison.parts);
  replace(byId("verdict"),
    h("p", {}, "Model: ", h("a", { href: at(`models/${model.id}`) }, titleOf(model)), `. Compared ${moment(comparison.createdAt)}.`),
    message(kind, h("p", {}, text)),
    h("p", { class: "actions" }, submitButton("Look for what is missing", diagnose),
      h("a", { class: "button quiet", href: at(`diagnose?comparison=${comparison.id}`) }, "With options")));
}

function drawTests({ parts }, titles, found) {
  const noiseKnown = parts.some((part) => part.noiseKnown);
  const notes = parts.flatMap((part) => part.notes ?? []).map((one) => message("warning", `${titles.get(one.experimentId) ?? one.experimentId}: ${one.text}.`));
  replace(byId("tests"), noiseKnown || parts.some((part) => part.simulationErrors.length) ? [...notes, overallTable(parts), disturbanceTable(parts, titles, found.output)]
    : message("warning", "The size of the noise is not known, as these data bring neither variances nor repeated periods; so nobody can say what is more than noise."));
}

function drawExperiments({ experiments }, titles, variables) {
  const rows = experiments.map((one) => [h("a", { href: at(`experiments/${one.experimentId}`) }, titles.get(one.experimentId) ?? one.experimentId),
    pointText(one.operatingPoint, variables), DATA[one.data], ...[one.fitPercent, one.refitPercent].map((value) => (value == null ? "–" : `${significant(value, 4)} %`))]);
  replace(byId("experiments"), table({ caption: "Fit: 100 (1 − ‖y − ŷ‖/‖y‖) at the excited lines", columns: ["experiment", "operating point", "data", "fit", "after a refit it would be"], rows, textColumns: 3 }));
}
