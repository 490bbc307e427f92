// One diagnosis: verdict, ranking, what is missing, confusability, visibility; an effect can be added from here.

import { get, list } from "../js/api.js";
import { context } from "../js/context.js";
import { AddEffect } from "../js/diagnose/add_effect.js";
import { drawConfusability } from "../js/diagnose/confusability.js";
import { drawDeciding } from "../js/diagnose/deciding.js";
import { MissingView } from "../js/diagnose/missing_view.js";
import { drawRanking } from "../js/diagnose/ranking.js";
import { reasons, VERDICTS } from "../js/diagnose/verdict.js";
import { drawVisibility } from "../js/diagnose/visibility.js";
import { byId, facts, h, message, replace } from "../js/dom.js";
import { ratio } from "../js/compare/lack_of_fit.js";
import { indexed, titleOf } from "../js/models/versions.js";
import { counted, moment, percent, significant } from "../js/numbers.js";
import { loadPlotly } from "../js/plots.js";
import { quantityText } from "../js/quantities.js";
import { page } from "../js/ready.js";
import { plant } from "../js/shell.js";

const at = (rest) => `/plants/${context.plantId}/${rest}`;

loadPlotly(); // while the data come
page(async () => {
  const query = { plantId: context.plantId };
  const [found, diagnosis, models, experiments] = await Promise.all([plant, get(`/diagnoses/${context.diagnosisId}`), list("/models", query), list("/experiments", query)]);
  const comparison = diagnosis.comparisonId ? await get(`/comparisons/${diagnosis.comparisonId}`) : null;
  const model = indexed(models).get(diagnosis.modelId);
  drawVerdict(diagnosis, model);
  const add = new AddEffect(byId("job"), { plant: found, diagnosis, comparison, model, models: indexed(models), experiments });
  drawRanking(byId("ranking"), diagnosis, { plant: found, add });
  drawDeciding(byId("deciding"), diagnosis, byId("job"));
  drawConfusability(byId("confusability"), diagnosis);
  drawVisibility(byId("visibility"), diagnosis);
  await new MissingView(byId("missing"), diagnosis, { plant: found, experiments: indexed(experiments) }).show();
});

function drawVerdict(diagnosis, model) {
  const { kind, text } = VERDICTS[diagnosis.verdict];
  replace(byId("verdict"),
    h("p", {}, "Model: ", h("a", { href: at(`models/${model.id}`) }, titleOf(model)), `. Judged by ${counted(diagnosis.experimentIds.length, "experiment")}, ${moment(diagnosis.createdAt)}. `,
      `Input: ${quantityText(diagnosis.inputQuantity)}; output: ${quantityText(diagnosis.outputQuantity)}. `,
      diagnosis.comparisonId ? h("a", { href: at(`compare/${diagnosis.comparisonId}`) }, "The comparison") : null),
    message(kind, h("p", {}, h("strong", {}, text)), ...reasons(diagnosis)),
    facts([significant(ratio(diagnosis.lackOfFit)), "χ² per degree of freedom now"], diagnosis.announced.length ? [significant(ratio(diagnosis.remaining)), "with the best effect"] : null,
      diagnosis.announced.length ? [percent(diagnosis.explainedShare), "explained of what noise does not explain"] : null, [String(diagnosis.ranking.length), "effects judged"]));
}
