// What a comparison says in one sentence.

import { probability, significant } from "../numbers.js";
import { DOUBTFUL, ratio } from "./lack_of_fit.js";

const NAMES = { fitted: "the fitted data", heldOut: "the held-out data" };
const nameOf = (part) => (part.scheduling === "varying" ? `${NAMES[part.data]} along p(t)` : NAMES[part.data]);

// {kind of message, text}
export function comparisonVerdict(parts) {
  const tests = parts.filter((part) => part.lackOfFit && part.lackOfFit.pValue != null);
  if (!tests.length) return { kind: "warning", text: "Whether anything is missing cannot be said, because the size of the noise is not known." };
  const failing = tests.filter((part) => part.lackOfFit.pValue < DOUBTFUL);
  const detail = tests.map((part) => `${nameOf(part)}: ${significant(ratio(part.lackOfFit))} (p-value ${probability(part.lackOfFit.pValue)})`).join("; ");
  if (!failing.length) return { kind: "success", text: `The model explains what was measured: what is left is noise. χ² per degree of freedom on ${detail}.` };
  const sure = failing.some((part) => part.lackOfFit.pValue < 1e-3);
  const refits = failing.every((part) => part.refitted && part.refitted.pValue >= DOUBTFUL);
  const hint = refits ? " A refit of its parameters would explain them: fit it once more." : "";
  return { kind: "warning", text: `${sure ? "The model fails: noise does not explain what is left" : "Noise alone hardly explains what is left"} on ${failing.map(nameOf).join(" and ")}. χ² per degree of freedom on ${detail}.${hint}` };
}
