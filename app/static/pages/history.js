// The versions of a model: the falling error, every version with what can be done from it, two of them side by side.

import { download, list } from "../js/api.js";
import { context } from "../js/context.js";
import { byId, h, message, replace } from "../js/dom.js";
import { field, select, submitButton } from "../js/forms.js";
import { drawPair } from "../js/history/pair.js";
import { broughtText, sinceText, staircasePlot, stepsOf } from "../js/history/staircase.js";
import { runJob } from "../js/jobs.js";
import { effectText } from "../js/models/effects.js";
import { datedTitle, effectsText, indexed, latest, lineage, titleOf } from "../js/models/versions.js";
import { moment, percent } from "../js/numbers.js";
import { loadPlotly } from "../js/plots.js";
import { showProblem } from "../js/problems.js";
import { page } from "../js/ready.js";
import { plant } from "../js/shell.js";
import { table } from "../js/tables.js";

const at = (rest) => `/plants/${context.plantId}/${rest}`;

loadPlotly(); // while the data come
page(async () => {
  const query = { plantId: context.plantId };
  const [found, models, experiments] = await Promise.all([plant, list("/models", query), list("/experiments", query)]);
  const known = indexed(models);
  const asked = known.get(new URLSearchParams(location.search).get("model"));
  const ends = latest(models);
  if (!models.length) return empty();
  const end = asked ?? ends[0];
  const line = lineage(end, known);
  const steps = stepsOf(line);
  drawHeadline(end, found, { asked: asked !== undefined, steps });
  drawVersions(line, steps, ends);
  replace(byId("staircase"));
  await Promise.all([
    steps.length > 1 ? staircasePlot(byId("staircase"), steps) : null,
    drawPair(byId("pair"), { line, steps, plant: found, experiments }),
  ]);
});

function empty() {
  replace(byId("staircase"), message("", h("p", {}, "There is no model yet. ", h("a", { href: at("models") }, "Identify one first."))));
  for (const id of ["versions", "pair"]) replace(byId(id));
}

function drawHeadline(model, found, { asked, steps }) {
  if (!model.extension) return replace(byId("headline"), h("p", { class: "lead" }, "Every version stays. To undo a step, go on from an earlier one."));
  const { kind, text, effect } = broughtText(model);
  return replace(byId("headline"),
    message(kind, h("p", {}, h("strong", {}, text)), h("p", {}, `Added: ${effect.title}, ${effectText(effect, found)}.`),
      steps.length > 2 ? sinceText(steps) : null),
    asked ? h("p", { class: "actions" }, h("a", { class: "button", href: at(`compare?model=${model.id}`) }, "Compare the new version"), h("a", { class: "button quiet", href: at(`models/${model.id}`) }, "Look at it")) : null);
}

async function downloadReport(model) {
  try {
    const { id } = await runJob(`/models/${model.id}/reports`, { name: "" }, byId("job"));
    await download(`/reports/${id}/file`);
  } catch (problem) {
    if (!problem.title) throw problem;
    showProblem(problem, { place: byId("job") });
  }
}

function drawVersions(line, steps, ends) {
  const step = (model) => steps.find((one) => one.model === model);
  const rows = [...line].map((model, i) => [
    h("a", { href: at(`models/${model.id}`) }, `${i + 1}. ${titleOf(model)}`),
    step(model) ? percent(step(model).fitted) : "–", step(model) && step(model).heldOut != null ? percent(step(model).heldOut) : "–",
    h("a", { href: at(`compare?model=${model.id}`) }, "Go on from here"), effectsText(model), moment(model.createdAt),
  ]);
  const chooser = select(ends.map((one) => [one.id, datedTitle(one)]), line.at(-1).id);
  if (!ends.includes(line.at(-1))) chooser.prepend(h("option", { value: line.at(-1).id, selected: true }, datedTitle(line.at(-1))));
  chooser.addEventListener("change", () => { location.search = `?model=${chooser.value}`; });
  const report = submitButton("Download the report of all this", () => downloadReport(line.at(-1)), { class: "quiet" });
  replace(byId("versions"),
    h("h2", {}, "Versions"), ends.length > 1 || !ends.includes(line.at(-1)) ? h("div", { class: "narrow" }, field("line of versions that ends with", chooser)) : null,
    table({ columns: ["version", "error, fitted", "error, held out", "undo", "effects", "made"], rows }), h("p", { class: "actions" }, report));
}
