// One design: the experiments, their certificate, what binds, the accuracy, the trade, the signals.

import { get } from "../js/api.js";
import { context } from "../js/context.js";
import { drawAccuracy } from "../js/design/accuracy.js";
import { bindingTable } from "../js/design/binding.js";
import { drawDecisions } from "../js/design/decisions.js";
import { drawSignals } from "../js/design/signals.js";
import { drawEnergies, drawSpectra, energyUnit } from "../js/design/spectra.js";
import { targetText } from "../js/design/target_fields.js";
import { drawTrade } from "../js/design/trade.js";
import { append, byId, facts, h, message, replace } from "../js/dom.js";
import { duration, exact, moment, percent, quantity } from "../js/numbers.js";
import { loadPlotly } from "../js/plots.js";
import { page } from "../js/ready.js";
import { plant } from "../js/shell.js";

loadPlotly(); // while the data come
page(async () => {
  const [described, design] = await Promise.all([plant, get(`/designs/${context.designId}`)]);
  const model = await get(`/models/${design.modelId}`);
  byId("title").textContent = design.request.name || "Design";
  replace(byId("summary"), summary(described, design, model));
  if (design.totalEnergy == null) return;
  append(byId("where"), [h("h2", {}, "Operating points and spectra")]);
  drawEnergies(byId("where"), described, design);
  drawSpectra(byId("where"), described, design);
  drawDecisions(byId("accuracy"), design);
  append(byId("accuracy"), [h("h2", {}, "Accuracy")]);
  drawAccuracy(byId("accuracy"), design, model);
  append(byId("accuracy"), [bindingTable(design, described)]);
  await Promise.all([drawTrade(byId("trade"), described, design), drawSignals(byId("signals"), described, design)]);
});

function summary(described, design, model) {
  const unit = energyUnit(described);
  const asked = h("ul", {}, design.request.targets.map((target) => h("li", {}, targetText(target, described))));
  const known = h("a", { href: `/plants/${described.id}/models/${design.modelId}` }, model.name || `${model.origin} model`);
  const from = h("p", { class: "hint" }, `Made ${moment(design.createdAt)} from what was known by the model `, known, design.request.usePriorInformation ? ", whose accuracy is counted in." : ".");
  if (design.totalEnergy == null) {
    return [message("problem", h("p", {}, h("strong", {}, "No experiments within these limits reach the accuracy asked for.")), design.outcome.advice), h("h2", {}, "Asked for"), asked, from];
  }
  return [
    facts([quantity(design.totalEnergy, unit, 4), "input energy Σu² in total"], [quantity(design.lowerBound, unit, 4), "no experiments need less, certified"],
      [percent(design.gap, 2), "gap between the two"], [String(design.experiments.length), "operating points"],
      [`${design.samples}`, `samples at each, ${duration(design.samples * design.sampleTimeSeconds)}`], [exact(design.sampleTimeSeconds, "s"), "sample time"]),
    design.outcome.advice ? message("warning", `${design.outcome.status.replaceAll("_", " ")}: ${design.outcome.advice}`) : null,
    h("h3", {}, "Asked for"), asked, from,
  ];
}
