// Where jobs lead: to the plant that they belong to, and to what they made.

import { download, get } from "./api.js";
import { h } from "./dom.js";
import { submitButton } from "./forms.js";

// Pages of what a job of a plant made, by its kind.
const PAGES = {
  experiments: ["the experiment", (id) => `experiments/${id}`],
  measurements: ["the experiments", () => "experiments"],
  models: ["the model", (id) => `models/${id}`],
  comparisons: ["the comparison", (id) => `compare/${id}`],
  diagnoses: ["the diagnosis", (id) => `diagnose/${id}`],
  designs: ["the design", (id) => `design/${id}`],
  staircases: ["the versions", () => "history"],
};
// What has to be looked up, or is a file.
const ACTIONS = {
  examples: ["the plant", async ({ href }) => go((await get(href)).plantId)],
  signals: ["the signals", async ({ href }) => { const { plantId, designId } = await get(href); go(plantId, `design/${designId}`); }],
  reports: ["the report", ({ href }) => download(`${href}/file`)],
};

const at = (plantId, rest) => `/plants/${plantId}${rest ? `/${rest}` : ""}`;
const go = (plantId, rest = "") => { location.href = at(plantId, rest); };

// The plant of a job by its name; `plants` by their identifiers. Null where a job has none.
export function plantLink(job, plants) {
  return job.plantId ? h("a", { href: at(job.plantId) }, plants.get(job.plantId)?.name ?? "the plant") : null;
}

// What a job made; null where it made nothing or nothing that has a page.
export function resultLink({ plantId, result }) {
  if (!result) return null;
  if (plantId && result.kind in PAGES) {
    const [name, path] = PAGES[result.kind];
    return h("a", { href: at(plantId, path(result.id)) }, name);
  }
  if (!(result.kind in ACTIONS)) return null;
  const [name, act] = ACTIONS[result.kind];
  return submitButton(name, () => act(result), { class: "quiet" });
}
