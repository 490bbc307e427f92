// A new diagnosis from a comparison, and the earlier ones of this plant.

import { list } from "../js/api.js";
import { context } from "../js/context.js";
import { VERDICTS } from "../js/diagnose/verdict.js";
import { byId, h, message, replace } from "../js/dom.js";
import { checkbox, field, fields, group, integerInput, numberOf, select, submitButton } from "../js/forms.js";
import { runJob } from "../js/jobs.js";
import { indexed, titleOf } from "../js/models/versions.js";
import { counted, moment } from "../js/numbers.js";
import { showProblem } from "../js/problems.js";
import { page } from "../js/ready.js";
import { table } from "../js/tables.js";

const at = (rest) => `/plants/${context.plantId}/${rest}`;
const DOMAINS = [["", "the whole library"], ["general", "effects of any plant"], ["mechanical", "those and mechanical ones"], ["electrical", "those and electrical ones"], ["impedance", "those and ones of impedances"]];

page(async () => {
  const query = { plantId: context.plantId };
  const [models, comparisons, diagnoses] = await Promise.all([list("/models", query), list("/comparisons", query, 200), list("/diagnoses", query, 100)]);
  drawForm(comparisons, indexed(models));
  drawEarlier(diagnoses, indexed(models));
});

function drawForm(comparisons, models) {
  const place = byId("form");
  if (!comparisons.length) return replace(place, message("", h("p", {}, "A diagnosis begins with a comparison. ", h("a", { href: at("compare") }, "Make one first."))));
  const title = (one) => `${models.has(one.modelId) ? titleOf(models.get(one.modelId)) : "a model"}, ${counted(one.experiments.length, "experiment")}, ${moment(one.createdAt)}`;
  const asked = new URLSearchParams(location.search).get("comparison");
  const comparison = select(comparisons.map((one) => [one.id, title(one)]), comparisons.some((one) => one.id === asked) ? asked : comparisons[0].id);
  const domain = select(DOMAINS, "");
  const degree = select([[0, "constant"], [1, "affine in the scheduling variable"], [2, "quadratic"], [3, "cubic"]], 0);
  const mean = checkbox(true);
  const seed = integerInput(0, { min: 0 });
  const form = h("form", { novalidate: true, onsubmit: (event) => event.preventDefault() },
    h("div", { class: "narrow" }, field("comparison", comparison, { pointer: "/comparisonId", hint: "judged by the experiments that were fitted, or by all if none was" })),
    group("Options", fields(field("effects to judge", domain, { pointer: "/domain" }), field("amplitudes are", degree, { pointer: "/amplitudeDegree" }),
      field("seed", seed, { pointer: "/seed", hint: "of the draws that p-values of the whole family come from" }),
      field("judge by the mean value of periodic records too", mean, { pointer: "/meanValue" }))),
    h("p", { class: "actions" }, submitButton("Look for what is missing", () => submit(), { type: "submit" })));
  const submit = async () => {
    const body = { comparisonId: comparison.value, domain: domain.value || null, amplitudeDegree: Number(degree.value), meanValue: mean.checked, seed: numberOf(seed) };
    try {
      const { id } = await runJob("/diagnoses", body, byId("job"));
      location.href = at(`diagnose/${id}`);
    } catch (problem) {
      showProblem(problem, { place, form });
    }
  };
  return replace(place, form);
}

function drawEarlier(diagnoses, models) {
  const place = byId("diagnoses");
  if (!diagnoses.length) return replace(place, h("p", { class: "hint" }, "There is none yet."));
  const names = (one) => one.announced.map((kind) => one.ranking.find((each) => each.kind === kind)?.title ?? kind).join(" or ") || "–";
  const rows = diagnoses.map((one) => [h("a", { href: at(`diagnose/${one.id}`) }, moment(one.createdAt)), models.has(one.modelId) ? titleOf(models.get(one.modelId)) : "a model", VERDICTS[one.verdict].short, names(one)]);
  return replace(place, table({ columns: ["diagnosis", "model", "verdict", "announced"], rows, textColumns: 4 }));
}
