// What the designed experiments can be expected to decide about effects.

import { append, h } from "../dom.js";
import { percent } from "../numbers.js";
import { words } from "../plugin_field.js";
import { table } from "../tables.js";

export function drawDecisions(place, { decisions }) {
  if (!decisions?.length) return;
  const rows = decisions.map((one) => [
    one.question === "detection" ? `is ${words(one.effect)} there?` : `${words(one.effect)} or ${words(one.against)}?`,
    percent(one.askedPower), percent(one.expectedPower), percent(one.level), one.probabilityOfWeightAbove95 == null ? "–" : percent(one.probabilityOfWeightAbove95),
  ]);
  append(place, [h("h2", {}, "What it decides"), table({
    caption: "Power: how often a test at this level decides rightly; the last column: how often a diagnosis gives the right effect more than 95 % of the weight",
    columns: ["question", "power asked for", "power expected", "level of the test", "more than 95 % weight"], rows })]);
}
