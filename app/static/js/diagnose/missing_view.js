// The smooth picture of what is missing at one experiment, with what the best effects explain of it laid over.

import { h, replace } from "../dom.js";
import { field, select } from "../forms.js";
import { logAxis } from "../log_axis.js";
import { experimentTitle, pointText } from "../models/experiments.js";
import { hertz, significant } from "../numbers.js";
import { dash, faded, seriesColour } from "../palette.js";
import { axis, plot } from "../plots.js";
import { colour } from "../theme.js";

const NORMAL_95 = 1.96;

export class MissingView {
  constructor(place, diagnosis, { plant, experiments }) {
    Object.assign(this, { place, plant });
    this.rows = diagnosis.missing.filter((one) => one.frequenciesRadPerSecond.some((omega) => omega > 0));
    this.titles = new Map(diagnosis.ranking.map((one) => [one.kind, one.title]));
    const label = (row) => (experiments.has(row.experimentId) ? experimentTitle(experiments.get(row.experimentId), plant.schedulingVariables) : pointText(row.operatingPoint, plant.schedulingVariables));
    this.chooser = select(this.rows.map((row, i) => [i, label(row)]), String(worst(this.rows)));
    this.chooser.addEventListener("change", () => this.#draw());
    this.inner = h("div", {});
  }

  async show() {
    if (!this.rows.length) return replace(this.place, h("p", { class: "hint" }, "There is no picture of it, as no lines were excited."));
    replace(this.place, h("div", { class: "fields" }, field("experiment", this.chooser)), this.inner);
    return this.#draw();
  }

  #draw() {
    replace(this.inner);
    const row = pictured(this.rows[Number(this.chooser.value)]);
    const name = (kind) => this.titles.get(kind) ?? kind;
    const [input, output] = [this.plant.input?.unit, this.plant.output?.unit];
    const unit = input && output ? ` (${output}/${input})` : "";
    return plot(this.inner, {
      caption: "What is missing from the frequency response, smoothed (broad line); grey: what may be noise, 95 %; thin lines: what the effects of most weight explain of it.", height: 380,
      draw: () => ({ data: traces(row, name), layout: { xaxis: logAxis("frequency (Hz)", row.x), yaxis: axis(`missing gain${unit}`, { rangemode: "tozero" }) } }),
      table: () => ({ columns: ["frequency (Hz)", `missing${unit}`, "noise, 95 %", ...row.explained.map((one) => name(one.kind))],
        rows: row.x.map((x, i) => [significant(x, 4), significant(row.size[i]), significant(row.noise[i]), ...row.explained.map((one) => significant(one.size[i]))]) }),
    });
  }
}

const sizesOf = (vector) => vector.re.map((re, i) => Math.hypot(re, vector.im[i]));

function pictured(row) {
  const places = row.frequenciesRadPerSecond.map((_, i) => i).filter((i) => row.frequenciesRadPerSecond[i] > 0);
  const take = (values) => places.map((i) => values[i]);
  return {
    x: take(row.frequenciesRadPerSecond).map(hertz), size: take(sizesOf(row.response)), noise: take(row.standardDeviation).map((one) => NORMAL_95 * one),
    explained: row.explained.map((one) => ({ kind: one.kind, size: take(sizesOf(one.response)) })),
  };
}

function worst(rows) {
  const excess = rows.map((row) => sizesOf(row.response).reduce((sum, size, i) => sum + (size / row.standardDeviation[i]) ** 2, 0) / row.standardDeviation.length);
  return Math.max(excess.indexOf(Math.max(...excess)), 0);
}

function traces(row, name) {
  const line = (y, title, style) => ({ x: row.x, y, mode: "lines", name: title, line: style });
  return [
    { ...line(row.noise, "noise, 95 %", { width: 0 }), fill: "tozeroy", fillcolor: faded(colour("--edge"), 0.35) },
    line(row.size, "missing", { color: colour("--quiet"), width: 7 }),
    ...row.explained.map((one, i) => line(one.size, name(one.kind), { color: seriesColour(i), dash: dash(i), width: 2.4 })),
  ];
}
