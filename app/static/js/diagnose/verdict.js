// What a diagnosis says in plain words.

import { percent, probability, significant } from "../numbers.js";

export const VERDICTS = {
  nothingMissing: { kind: "success", short: "nothing missing", text: "Nothing is missing that these experiments could show." },
  explained: { kind: "success", short: "explained", text: "Something is missing, and the library explains it." },
  partlyExplained: { kind: "warning", short: "partly explained", text: "Something is missing. The best effect explains a part of it, and something else remains." },
  notInTheLibrary: { kind: "warning", short: "not in the library", text: "Something is missing, and no effect of the library has its shape. The picture below shows where it acts." },
  cannotBeJudged: { kind: "warning", short: "cannot be judged", text: "These experiments cannot say whether something is missing." },
};

// The sentences below the verdict.
export function reasons(diagnosis) {
  const titles = new Map(diagnosis.ranking.map((one) => [one.kind, one.title]));
  const names = diagnosis.announced.map((kind) => titles.get(kind) ?? kind);
  const found = diagnosis.reason ? [`${diagnosis.reason.charAt(0).toUpperCase()}${diagnosis.reason.slice(1)}.`] : [];
  for (const one of diagnosis.variations ?? []) if (!one.explains) found.unshift(`${one.title}: ${significant(one.size)} (${one.unit}; p-value ${probability(one.pValue)}). ${one.advice}.`);
  if (names.length === 1) found.push(`Announced: ${names[0]}, with ${percent(diagnosis.ranking[0].evidence.weight)} of the weight of all that was tried.`);
  if (names.length > 1) found.push(`These cannot be told apart here: ${names.slice(0, -1).join(", ")} and ${names.at(-1)}. Another experiment must decide.`);
  if (names.length) found.push(`The best effect takes away ${percent(diagnosis.explainedShare)} of what noise does not explain; what then remains has a p-value of ${probability(diagnosis.remaining.pValue)}.`);
  if (names.length && diagnosis.noneOfTheseWeight != null) found.push(`None of these: ${percent(diagnosis.noneOfTheseWeight)} of the weight.`);
  return found;
}
