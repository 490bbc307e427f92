// What a diagnosis says in plain words.

import { percent, probability } from "../numbers.js";

export const VERDICTS = {
  nothingMissing: { kind: "success", short: "nothing missing", text: "Nothing is missing that these experiments could show: what is left is noise." },
  explained: { kind: "success", short: "explained", text: "Something is missing, and the library explains it: what then remains is noise." },
  partlyExplained: { kind: "warning", short: "partly explained", text: "Something is missing. The best effect explains a part of it, and something else remains." },
  notInTheLibrary: { kind: "warning", short: "not in the library", text: "Something is missing, and no effect of the library has its shape. The picture below shows where it acts." },
};

// The sentences below the verdict.
export function reasons(diagnosis) {
  const titles = new Map(diagnosis.ranking.map((one) => [one.kind, one.title]));
  const names = diagnosis.announced.map((kind) => titles.get(kind) ?? kind);
  const found = [];
  if (names.length === 1) found.push(`Announced: ${names[0]}, with ${percent(diagnosis.ranking[0].evidence.weight)} of the weight${diagnosis.confident ? ", and what it leaves is noise" : ""}.`);
  if (names.length > 1) found.push(`These cannot be told apart here: ${names.slice(0, -1).join(", ")} and ${names.at(-1)}. Another experiment must decide.`);
  if (names.length) found.push(`The best effect takes away ${percent(diagnosis.explainedShare)} of what noise does not explain; what then remains has a p-value of ${probability(diagnosis.remaining.pValue)}.`);
  return found;
}
