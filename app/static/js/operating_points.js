// Operating points on the axes of the scheduling variables.

import { labelled, pointLabel } from "./numbers.js";
import { axis, plot } from "./plots.js";
import { symbol } from "./palette.js";

// groups: [{name, points}], each a set of operating points with a symbol of its own; draws nothing without points.
export function operatingPoints(place, variables, groups, caption) {
  const filled = groups.filter((one) => one.points.length);
  if (!filled.length) return null;
  const two = variables.length > 1;
  const range = (variable) => {
    const slack = 0.04 * (variable.maximum - variable.minimum);
    return [variable.minimum - slack, variable.maximum + slack];
  };
  const title = (variable) => labelled(variable.name, variable.unit);
  const heights = two ? null : stacked(filled);
  return plot(place, {
    caption,
    height: two ? 320 : 200,
    draw: () => ({
      data: filled.map((one, i) => ({
        x: one.points.map((point) => point[0]), y: two ? one.points.map((point) => point[1]) : heights[i],
        text: one.points.map((point) => pointLabel(point, variables)), hoverinfo: "text",
        name: one.name, mode: "markers", marker: { symbol: symbol(i), size: 10, opacity: 0.8 },
      })),
      layout: {
        xaxis: axis(title(variables[0]), { range: range(variables[0]) }),
        yaxis: two ? axis(title(variables[1]), { range: range(variables[1]) }) : axis("count", { rangemode: "tozero", dtick: 1 }),
        showlegend: filled.length > 1,
      },
    }),
    table: () => ({ columns: ["operating point", "of"], textColumns: 2,
      rows: filled.flatMap((one) => one.points.map((point) => [pointLabel(point, variables), one.name])) }),
  });
}

// Points that coincide stand on top of each other.
function stacked(groups) {
  const seen = new Map();
  return groups.map((one) => one.points.map(([value]) => {
    seen.set(value, (seen.get(value) ?? 0) + 1);
    return seen.get(value);
  }));
}
