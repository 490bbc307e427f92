// A new design, and the earlier ones of this plant.

import { get, list } from "../js/api.js";
import { context } from "../js/context.js";
import { known } from "../js/design/known.js";
import { limits } from "../js/design/limits.js";
import { targetText } from "../js/design/target_fields.js";
import { targets } from "../js/design/targets.js";
import { isTrial } from "../js/design/trade.js";
import { where } from "../js/design/where.js";
import { byId, h, message, replace } from "../js/dom.js";
import { group, submitButton } from "../js/forms.js";
import { runJob } from "../js/jobs.js";
import { moment, quantity } from "../js/numbers.js";
import { showProblem } from "../js/problems.js";
import { page } from "../js/ready.js";
import { plant } from "../js/shell.js";
import { table } from "../js/tables.js";

const at = (id) => `/plants/${context.plantId}/design/${id}`;

page(async () => {
  const query = { plantId: context.plantId };
  const [described, catalogue, models, designs, experiments] = await Promise.all([
    plant, get("/catalogue"), list("/models", query, 100), list("/designs", query, 500), list("/experiments", query)]);
  drawEarlier(described, designs.filter((one) => !isTrial(one)));
  if (described.structure.timeDomain.endsWith("StateSpace")) {
    replace(byId("form"), message("", "Plants in state space are not designed for yet."));
  } else {
    drawForm(described, catalogue, models, experiments);
  }
});

function drawForm(described, catalogue, models, experiments) {
  const place = byId("form");
  const parts = {
    known: known(described, models, new URLSearchParams(location.search).get("model")),
    targets: targets(catalogue, described), where: where(described.schedulingVariables), limits: limits(catalogue, described, experiments),
  };
  const form = h("form", { novalidate: true, onsubmit: (event) => event.preventDefault() },
    group("How accurately do you want to know the plant?", parts.targets.element),
    group("What is known now", parts.known.element),
    group("Operating points", parts.where.element),
    group("What is allowed", parts.limits.element),
    h("p", { class: "actions" }, submitButton("Design the experiments", () => submit(parts, place, form), { type: "submit" })));
  replace(place, form);
}

async function submit(parts, place, form) {
  try {
    const modelId = await parts.known.modelId();
    const body = { plantId: context.plantId, modelId, targets: parts.targets.value(), ...parts.where.value(), ...parts.limits.value() };
    const { id } = await runJob("/designs", body, byId("job"));
    location.href = at(id);
  } catch (problem) {
    if (!problem.title) throw problem;
    showProblem(problem, { place, form });
  }
}

function drawEarlier(described, designs) {
  const place = byId("designs");
  if (!designs.length) return replace(place, h("p", { class: "hint" }, "There is none yet."));
  const unit = described.input?.unit ? `${described.input.unit}²` : "";
  const rows = designs.map((one) => [h("a", { href: at(one.id) }, one.request.name || moment(one.createdAt)),
    one.request.targets.map((target) => targetText(target, described)).join("; "), String(one.experiments.length), quantity(one.totalEnergy, unit, 4), one.outcome.status.replaceAll("_", " ")]);
  return replace(place, table({ columns: ["design", "asked for", "experiments", "energy Σu²", "outcome"], rows, textColumns: 2 }));
}
