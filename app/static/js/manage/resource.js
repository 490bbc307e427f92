// Which resource a page is about, and where pages of resources are.

import { context } from "../context.js";

// Of each collection: the name of its identifier in `context`, its folder below the plant, what one is called.
const KINDS = {
  experiments: ["experimentId", "experiments", "experiment", "experiments"],
  models: ["modelId", "models", "model", "models"],
  comparisons: ["comparisonId", "compare", "comparison", "comparisons"],
  diagnoses: ["diagnosisId", "diagnose", "diagnosis", "diagnoses"],
  designs: ["designId", "design", "design", "designs"],
  plants: ["plantId", "", "plant", "plants"],
};
const OTHERS = { signals: ["set of signals", "sets of signals"], staircases: ["history of versions", "histories of versions"], simulations: ["simulation", "simulations"], reports: ["report", "reports"], examples: ["example", "examples"] };

// The resource of this page, or null: {collection, id, word, back} with the page of the list that it stands in.
export function ownResource() {
  for (const [collection, [key, folder, word]] of Object.entries(KINDS)) {
    const id = context[key];
    if (!id || !location.pathname.endsWith(`/${id}`)) continue;
    return { collection, id, word, back: collection === "plants" ? "/plants" : `/plants/${context.plantId}/${folder}` };
  }
  return null;
}

// "2 models", "1 comparison".
export function counted(collection, count) {
  const [one, many] = KINDS[collection]?.slice(2) ?? OTHERS[collection] ?? [collection, collection];
  return `${count} ${count === 1 ? one : many}`;
}

export const wordOf = (collection) => counted(collection, 1).slice(2);

// The page of a resource, from its document; null where it has none.
export function pageOf(collection, document) {
  if (collection === "plants") return `/plants/${document.id}`;
  const folder = KINDS[collection]?.[1];
  return folder && document.plantId ? `/plants/${document.plantId}/${folder}/${document.id}` : null;
}
