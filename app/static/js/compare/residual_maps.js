// The maps of normalised residuals, fitted and held-out side by side; what is chosen in one is found in the other.

import { h, replace } from "../dom.js";
import { FieldMap } from "../map.js";
import { byPoint, pointText } from "../models/experiments.js";
import { counted, hertz, significant } from "../numbers.js";

export const DATA = { fitted: "fitted", heldOut: "held out" };
export const nameOf = (part) => (part.scheduling === "varying" ? `${DATA[part.data]}, along p(t)` : DATA[part.data]);
const CLASSES = { excited: "excited line", unexcitedOdd: "unexcited odd line", unexcitedEven: "unexcited even line" };
const LEAST_TOP = 4;

// rows: of /comparisons/{id}/maps; onChoose({experimentId, frequency, data}) after a click or Enter.
export class ResidualMaps {
  constructor(place, rows, { variables, titles, onChoose }) {
    this.variables = variables;
    this.titles = titles;
    this.onChoose = onChoose;
    const top = topOf(rows.map(sizes));
    this.parts = Object.keys(DATA).map((data) => ({ data, rows: rows.filter((row) => row.data === data).sort((a, b) => byPoint(a.operatingPoint, b.operatingPoint)) })).filter((part) => part.rows.length);
    const columns = h("div", { class: "columns" });
    replace(place, columns);
    for (const part of this.parts) this.#draw(columns, part, top);
  }

  // The cell that is furthest off.
  worst() {
    const cells = this.parts.flatMap((part) => part.rows.flatMap((row, i) => {
      const values = sizes(row);
      const column = values.reduce((best, value, j) => (value > values[best] ? j : best), 0);
      return values.length ? [{ part, row: i, column, value: values[column] }] : [];
    }));
    return cells.sort((a, b) => b.value - a.value)[0] ?? null;
  }

  // Choose a cell, as a click would.
  choose({ part, row, column }) {
    part.map.choose(row, column);
    this.#chosen(part, row, column);
  }

  // In the other part: the experiment whose operating point is nearest.
  counterpart(experimentId) {
    const [part, row] = this.#find(experimentId);
    const other = this.parts.find((one) => one !== part);
    const distance = (one) => Math.hypot(...(one.operatingPoint ?? []).map((value, i) => (value - (row.operatingPoint?.[i] ?? value)) / this.#width(i)));
    return other ? [...other.rows].sort((a, b) => distance(a) - distance(b))[0] : null;
  }

  #draw(columns, part, top) {
    const place = h("section", {}, h("h3", {}, `${part.data === "fitted" ? "Fitted" : "Held out"}: ${counted(part.rows.length, "experiment")}`));
    columns.append(place);
    const labels = labelsOf(part.rows, this.variables);
    part.map = new FieldMap(place, {
      rows: part.rows.map((row, i) => ({ label: labels[i], frequencies: row.frequenciesRadPerSecond.map(hertz), values: sizes(row) })),
      kind: "sequential", minimum: 0, maximum: top, frequencyTitle: "frequency (Hz)", valueTitle: "misfit over noise",
      caption: `Misfit of ${DATA[part.data]} experiments in standard deviations, over frequency and operating point.`,
      describe: (row, column) => this.#describe(part.rows[row], column),
      onChoose: (row, column) => this.#chosen(part, row, column),
      table: () => tableOf(part.rows, labels),
    });
  }

  #describe(row, column) {
    const frequency = significant(hertz(row.frequenciesRadPerSecond[column]), 4);
    const point = pointText(row.operatingPoint, this.variables);
    return `${point}, ${frequency} Hz: ${significant(sizes(row)[column])} times the noise, ${CLASSES[row.lineClasses[column]]} (${this.titles.get(row.experimentId) ?? "experiment"})`;
  }

  #chosen(part, row, column) {
    const { experimentId, frequenciesRadPerSecond } = part.rows[row];
    const frequency = frequenciesRadPerSecond[column];
    const other = this.counterpart(experimentId);
    if (other) this.#mark(other, frequency);
    this.onChoose({ experimentId, frequency, counterpartId: other?.experimentId ?? null });
  }

  #mark(row, frequency) {
    const [part] = this.#find(row.experimentId);
    const gaps = row.frequenciesRadPerSecond.map((one) => Math.abs(one - frequency));
    part.map.choose(part.rows.indexOf(row), gaps.indexOf(Math.min(...gaps)));
  }

  #find(experimentId) {
    for (const part of this.parts) for (const row of part.rows) if (row.experimentId === experimentId) return [part, row];
    return [null, null];
  }

  #width(i) {
    return this.variables[i].maximum - this.variables[i].minimum || 1;
  }
}

// |z| of a row; E|z|² = 1 where only noise is left.
const known = new WeakMap();
export function sizes(row) {
  if (!known.has(row)) known.set(row, row.residual.re.map((re, i) => Math.hypot(re, row.residual.im[i])));
  return known.get(row);
}

// Where the colours end: all but the largest fiftieth lie below.
function topOf(rows) {
  const all = Float64Array.from(rows.flat()).sort();
  return Math.max(LEAST_TOP, Number((all[Math.floor(0.98 * (all.length - 1))] ?? 0).toPrecision(2)));
}

// Operating points as labels; several records at one of them are numbered.
function labelsOf(rows, variables) {
  const seen = new Map();
  return rows.map((row) => {
    const point = row.operatingPoint?.map((value, i) => `${Number(value.toPrecision(4))} ${variables[i].unit}`.trim()).join(", ") ?? "varying";
    seen.set(point, (seen.get(point) ?? 0) + 1);
    return seen.get(point) > 1 ? `${point} · ${seen.get(point)}` : point;
  });
}

function tableOf(rows, labels) {
  const cells = rows.flatMap((row, i) => sizes(row).map((value, j) => [labels[i], hertz(row.frequenciesRadPerSecond[j]), value, row.lineClasses[j]]));
  cells.sort((a, b) => b[2] - a[2]);
  return { caption: "Largest first", columns: ["operating point", "frequency (Hz)", "misfit over noise", "line"],
    rows: cells.slice(0, 1000).map(([label, frequency, value, kind]) => [label, significant(frequency, 4), significant(value), CLASSES[kind]]) };
}
