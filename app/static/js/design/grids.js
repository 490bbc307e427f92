// Sets of operating points.

// All combinations of the values of each variable.
export function combinations(axes) {
  return axes.reduce((points, values) => points.flatMap((point) => values.map((value) => [...point, value])), [[]]);
}

// `count` equidistant values of a range.
export function spread({ minimum, maximum }, count) {
  if (count === 1) return [(minimum + maximum) / 2];
  return Array.from({ length: count }, (_, i) => minimum + ((maximum - minimum) * i) / (count - 1));
}

// The operating points in a text: numbers separated by spaces or commas, points by lines or semicolons.
export function pointsIn(text, size) {
  const rows = text.split(/[;\n]/).map((row) => row.split(/[\s,]+/).filter(Boolean).map(Number)).filter((row) => row.length);
  return size === 1 ? rows.flat().map((value) => [value]) : rows;
}
