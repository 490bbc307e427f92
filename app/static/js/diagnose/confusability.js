// What can be confused: squared cosines between the signatures of effects, as a table with shaded cells.

import { h, replace } from "../dom.js";
import { nameOf } from "./ranking.js";

const MOST = 8;
const ALIKE = 0.9;

export function drawConfusability(place, diagnosis) {
  const count = diagnosis.ranking.length;
  if (count < 2) return replace(place, h("p", { class: "hint" }, "Fewer than two effects were judged."));
  const refitted = diagnosis.ranking.filter((one) => one.evidence).length;
  const first = Math.min(refitted > 1 ? refitted : MOST, MOST, count);
  const holder = h("div", {}, matrix(diagnosis, first));
  const all = h("button", { type: "button", class: "quiet", "aria-pressed": "false", onclick: () => toggle() }, `All ${count}`);
  const toggle = () => {
    const shown = all.getAttribute("aria-pressed") === "true";
    all.setAttribute("aria-pressed", String(!shown));
    replace(holder, matrix(diagnosis, shown ? first : count));
  };
  return replace(place,
    h("p", { class: "hint" }, "How alike the effects look in these experiments, once the parameters of the model have taken up what they can: 0 nothing in common, 1 cannot be told apart here."),
    pairs(diagnosis, first), holder, count > first ? h("p", { class: "actions" }, all) : null);
}

// In words: what is most alike to the best effects.
function pairs({ ranking, confusability }, count) {
  const found = [];
  for (let i = 0; i < count; i += 1) {
    for (let j = i + 1; j < count; j += 1) if (confusability[i][j] >= ALIKE) found.push([i, j]);
  }
  if (!found.length) return h("p", {}, "None of the first effects look alike here.");
  return h("ul", {}, found.map(([i, j]) => h("li", {}, `${nameOf(ranking[i])} and ${nameOf(ranking[j])}: ${confusability[i][j].toFixed(2)}`)));
}

function matrix({ ranking, confusability }, count) {
  const numbers = Array.from({ length: count }, (_, i) => i);
  const cell = (i, j) => h("td", { class: i !== j && confusability[i][j] >= ALIKE ? "alike" : null, style: `--share:${confusability[i][j].toFixed(3)}` }, i === j ? "" : confusability[i][j].toFixed(2));
  return h("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "What can be confused" },
    h("table", { class: "matrix" }, h("caption", {}, "Squared cosine between the signatures"),
      h("thead", {}, h("tr", {}, h("th", { scope: "col", class: "text" }, "effect"), numbers.map((i) => h("th", { scope: "col" }, h("abbr", { title: nameOf(ranking[i]) }, String(i + 1)))))),
      h("tbody", {}, numbers.map((i) => h("tr", {}, h("th", { scope: "row", class: "text" }, `${i + 1}. ${nameOf(ranking[i])}`), numbers.map((j) => cell(i, j)))))));
}
