// One plant: what it is, how far the loop has come, what to do next.

import { list } from "../js/api.js";
import { context } from "../js/context.js";
import { byId, facts, h, message, replace } from "../js/dom.js";
import { counted, exact, labelled, moment } from "../js/numbers.js";
import { quantityText } from "../js/quantities.js";
import { page } from "../js/ready.js";
import { plant } from "../js/shell.js";
import { structureText } from "../js/structure_fields.js";
import { table } from "../js/tables.js";

const at = (step) => `/plants/${context.plantId}/${step}`;
// What is made, where, and what it is for, in the order of the loop.
const STEPS = [
  ["experiments", "experiments", "experiment", "Bring in records or frequency responses, each at one operating point."],
  ["models", "models", "model", "Identify a model from experiments."],
  ["comparisons", "compare", "comparison", "Hold a model against measurements and see where it fails."],
  ["diagnoses", "diagnose", "diagnosis", "See which physical effect is missing, and add it."],
  ["designs", "design", "design", "Design the experiments that give the accuracy you need with the least energy."],
];

page(async () => {
  const found = await plant;
  byId("title").textContent = found.name;
  const query = { plantId: context.plantId };
  const counts = await Promise.all(STEPS.map(async ([collection]) => (await list(`/${collection}`, query, 500)).length));
  replace(byId("about"), about(found));
  replace(byId("steps"), h("ol", { class: "cards" }, STEPS.map((step, index) => card(step, counts[index]))));
  replace(byId("next"), message("success", h("p", {}, h("strong", {}, "Next: "), next(counts))));
});

function about(found) {
  const unit = (signal) => [labelled(signal.name, signal.unit), signal.quantity ? quantityText(signal.quantity) : null].filter(Boolean).join(": ");
  const signals = (one, several) => (one ? unit(one) : several.map(unit).join(", "));
  return [
    found.description ? h("p", {}, found.description) : null,
    facts([signals(found.input, found.inputs), "input"], [signals(found.output, found.outputs), "output"],
      [String(found.parameterNames.length), "parameters"], [String(found.neededOperatingPoints), "operating points needed at least"]),
    h("p", {}, `Structure: ${structureText(found.structure)}. Described ${moment(found.createdAt)}.`),
    table({ caption: "Scheduling variables", columns: ["name", "unit", "least value", "largest value"], textColumns: 2,
      rows: found.schedulingVariables.map((one) => [one.name, one.unit || "none", exact(one.minimum), exact(one.maximum)]) }),
  ];
}

function card([, path, name, purpose], count) {
  const many = name === "diagnosis" ? "diagnoses" : `${name}s`;
  return h("li", {}, h("h3", {}, h("a", { href: at(path) }, count ? counted(count, name, many) : `No ${name} yet`)), h("p", { class: "quiet-text" }, purpose));
}

function next([experiments, models, comparisons, diagnoses]) {
  const step = experiments === 0 ? ["experiments", "bring in what you have measured"]
    : models === 0 ? ["identify", "identify a model"]
      : comparisons === 0 ? ["compare", "hold the model against the measurements"]
        : diagnoses === 0 ? ["diagnose", "see what is missing"]
          : ["history", "see how the error has fallen"];
  return h("a", { href: at(step[0]) }, step[1]);
}
