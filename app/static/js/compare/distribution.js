// How the normalised residuals are distributed, against what noise alone would give.

import { significant } from "../numbers.js";
import { dash, seriesColour } from "../palette.js";
import { axis, plot } from "../plots.js";
import { colour } from "../theme.js";
import { DATA, sizes } from "./residual_maps.js";

const MOST = 300;
const NOISE = Array.from({ length: 120 }, (_, i) => 10 ** (-1 + (i * 1.5) / 119)).filter((z) => Math.exp(-z * z) > 1e-5);

// Draw the share of lines whose residual |z| exceeds a size; of noise alone that share is exp(−|z|²).
export function distributionPlot(place, parts) {
  const curves = parts.map(({ data, rows }) => ({ data, ...exceeded(rows.flatMap(sizes)) }));
  return plot(place, {
    caption: "Share of all lines whose misfit exceeds a size. Where only noise is left the curves follow the dashed one.",
    height: 300,
    draw: () => ({
      data: [{ x: NOISE, y: NOISE.map((z) => Math.exp(-z * z)), mode: "lines", name: "noise alone", line: { color: colour("--quiet"), dash: "dash", width: 2 } },
        ...curves.map((one, i) => ({ x: one.x, y: one.y, mode: "lines", name: DATA[one.data], line: { color: seriesColour(i), dash: i ? dash(3) : "solid", width: 2.4 } }))],
      layout: { xaxis: axis("misfit over noise", { log: true }), yaxis: axis("share of lines", { log: true }) },
    }),
    table: () => ({ columns: ["misfit over noise", ...curves.map((one) => `share of lines, ${DATA[one.data]}`), "share of noise alone"],
      rows: [0.5, 1, 1.5, 2, 2.5, 3, 5, 10, 30, 100].map((z) => [significant(z, 2), ...curves.map((one) => significant(one.share(z))), significant(Math.exp(-z * z))]) }),
  });
}

function exceeded(values) {
  const sorted = Float64Array.from(values).sort();
  const count = sorted.length;
  // Close together at the upper end, where few lines are left.
  const places = [...new Set(Array.from({ length: MOST }, (_, i) => Math.min(Math.floor(count * (1 - (1 / count) ** (i / (MOST - 1)))), count - 1)))];
  return {
    x: places.map((i) => Math.max(sorted[i], 0.1)), y: places.map((i) => (count - i) / count),
    share: (z) => values.filter((one) => one > z).length / count,
  };
}
