// The missing effects, ranked, with what speaks for each of them.

import { context } from "../context.js";
import { h, replace } from "../dom.js";
import { effectText } from "../models/effects.js";
import { percent, probability, significant } from "../numbers.js";
import { tableBehind } from "../tables.js";

// add: AddEffect of this diagnosis.
export function drawRanking(place, diagnosis, { plant, add }) {
  const refitted = diagnosis.ranking.filter((one) => one.evidence);
  replace(place,
    refitted.length ? h("p", { class: "hint" }, "Each was fitted together with the parameters of the model. The weight says how the evidence divides among them and none of these.") : h("p", {}, "No effect stands out."),
    refitted.length ? [h("ol", { class: "effects" }, refitted.map((one) => entry(one, { plant, add }))), untilNoise(add), add.panel] : null,
    tableBehind(() => ({ columns: ["effect", "acts on", "score", "p-value", "adjusted p-value"], textColumns: 2,
      rows: diagnosis.ranking.map((one) => [nameOf(one), one.place, significant(one.score), probability(one.pValue), probability(one.adjustedPValue)]) }), `All ${diagnosis.ranking.length} effects that were judged`));
}

function entry(one, { plant, add }) {
  const { evidence } = one;
  const button = h("button", { type: "button", class: one.announced ? "" : "quiet", "data-effect": one.kind, "aria-label": `Add this effect: ${nameOf(one)}`, onclick: (event) => add.start(one, event.target) }, "Add this effect");
  const held = evidence.atBound ? h("p", { class: "hint" }, "At the end of its physical range: no estimate, and no interval.") : null;
  const stopped = evidence.outcome.status === "converged" ? null : h("p", { class: "hint" }, evidence.outcome.advice || evidence.outcome.status.replaceAll("_", " "));
  return h("li", {},
    h("div", {}, h("h3", {}, nameOf(one), one.announced ? h("span", { class: "tag" }, "announced") : null), h("p", { class: "hint" }, `acts on: ${one.place}`), one.reading ? h("p", { class: "hint" }, `${one.reading}.`) : null),
    h("div", {}, h("p", {}, effectText(evidence.effect, plant)), held, stopped),
    h("div", {}, weightBar(evidence.weight), h("p", { class: "hint" }, `χ² explained per parameter: ${significant(evidence.chiSquarePerParameter)}; adjusted p-value: ${probability(one.adjustedPValue)}`)),
    button);
}

function untilNoise(add) {
  return h("p", { class: "actions" }, h("button", { type: "button", class: "quiet", onclick: (event) => add.startStaircase(event.target) }, "Add effects until noise explains what is left"));
}

export const nameOf = (one) => (one.quantity ? `${one.title}: ${one.quantity}` : one.title);

function weightBar(weight) {
  const text = weight < 0.0005 ? "below 0.1 %" : percent(weight);
  return h("span", { class: "weight" }, h("span", { class: "weight-bar", style: `--share:${Math.max(weight, 0)}` }), h("span", {}, `weight ${text}`));
}

export const historyPath = (modelId) => `/plants/${context.plantId}/history?model=${modelId}`;
