// Logarithmic axes with labels that can be read: 1, 2 and 5 where few decades are shown, powers of ten where many are.

import { axis } from "./plots.js";

const FEW = 2.6; // decades

// An axis for these values; `more` as for `axis`.
export function logAxis(title, values, more = {}) {
  const known = values.filter((one) => one > 0);
  const [low, high] = [Math.log10(Math.min(...known)), Math.log10(Math.max(...known))];
  if (!(high - low < FEW)) return axis(title, { log: true, ...more });
  const decades = Array.from({ length: Math.ceil(high) - Math.floor(low) + 2 }, (_, i) => 10 ** (Math.floor(low) - 1 + i));
  const tickvals = decades.flatMap((decade) => (high - low < 0.5 ? [1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9] : [1, 2, 5]).map((digit) => Number((digit * decade).toPrecision(2))));
  return axis(title, { log: true, tickvals, ticktext: tickvals.map((one) => String(one)), ...more });
}
