// Where a model came from: its experiments, design, parent, estimators, software version and seed.

import { context } from "../context.js";
import { h } from "../dom.js";
import { counted, moment } from "../numbers.js";
import { words } from "../plugin_field.js";
import { tableBehind, table } from "../tables.js";
import { experimentTitle } from "./experiments.js";
import { titleOf } from "./versions.js";

const at = (rest) => `/plants/${context.plantId}/${rest}`;
const ORIGINS = { identified: "identified from experiments", stated: "stated", extended: "an effect was added, all parameters fitted together" };

export function provenance(model, { plant, models, experiments }) {
  const parent = models.get(model.parentId);
  const rows = [
    ["made", `${moment(model.createdAt)} by version ${model.softwareVersion}`],
    ["how", ORIGINS[model.origin]],
    parent && ["new version of", h("a", { href: at(`models/${parent.id}`) }, titleOf(parent))],
    model.designId && ["design", h("a", { href: at(`design/${model.designId}`) }, "the design that its experiments carry out")],
    model.extension?.diagnosisId && ["diagnosis", h("a", { href: at(`diagnose/${model.extension.diagnosisId}`) }, "the one that pointed to the effect")],
    ["local estimator", pluginText(model.localEstimator)], ["estimator over the range", pluginText(model.lpvEstimator)], ["spectra", pluginText(model.spectralEstimator)],
    ["seed", model.seed == null ? "none: nothing was drawn at random" : String(model.seed)],
    ["identifier", h("code", {}, model.id)],
  ].filter((row) => row && row[1]);
  const used = model.experimentIds.map((id) => [experiments.has(id)
    ? h("a", { href: at(`experiments/${id}`) }, experimentTitle(experiments.get(id), plant.schedulingVariables)) : h("code", {}, id)]);
  return [
    table({ columns: ["property", "value"], rows, textColumns: 2 }),
    used.length ? tableBehind(() => ({ columns: ["experiment"], rows: used }), `Its ${counted(used.length, "experiment")}`) : null,
  ];
}

function pluginText(document) {
  if (!document) return null;
  const { kind, ...options } = document;
  const given = Object.entries(options).filter(([, value]) => value != null).map(([name, value]) => `${words(name)} ${typeof value === "object" ? JSON.stringify(value) : value}`);
  return [words(kind), ...given].join(", ");
}
