// What was measured at a chosen cell of the maps: Bode plots of the experiment and of its counterpart, and the record.

import { get } from "../api.js";
import { bodePlot } from "../bode.js";
import { h, replace } from "../dom.js";
import { experimentTitle } from "../models/experiments.js";
import { bandOf, responseOf } from "../models/responses.js";
import { hertz, significant } from "../numbers.js";
import { linkAxes } from "../plots.js";
import { problemBox } from "../problems.js";
import { recordPlot } from "./record.js";
import { DATA } from "./residual_maps.js";

export class CellView {
  constructor(place, { plant, model, comparison, experiments }) {
    Object.assign(this, { place, plant, model, comparison, experiments });
    this.kept = new Map();
    this.turn = 0;
    this.drawn = null;
  }

  // Show a cell {experimentId, frequency, counterpartId}; what was asked for last wins.
  show(cell) {
    this.turn += 1;
    this.drawn = this.#draw(cell, this.turn);
    return this.drawn;
  }

  async #draw({ experimentId, frequency, counterpartId }, turn) {
    const experiment = this.experiments.get(experimentId);
    if (experiment?.kind === "varyingRecord") return this.#along(experiment, frequency);
    const identifiers = [experimentId, counterpartId].filter((id) => id && this.experiments.get(id)?.kind !== "varyingRecord");
    try {
      const found = await Promise.all(identifiers.map((id) => this.#fetched(id)));
      if (turn !== this.turn) return;
      const columns = found.map((one) => h("div", {}, h("h3", {}, this.#title(one))));
      const record = h("div", {});
      const height = this.place.offsetHeight;
      if (height) this.place.style.minHeight = `${height}px`; // so that the page does not jump
      replace(this.place, h("h2", {}, `At ${significant(hertz(frequency), 4)} Hz`), h("div", { class: "columns" }, columns), this.#leftOut(found), record);
      const charts = found.map((one, i) => this.#bode(columns[i], one, frequency));
      if (charts.length > 1) linkAxes(charts, ["xaxis", "yaxis", "yaxis2"]);
      if (experiment) await recordPlot(record, experiment, this.plant);
      this.place.style.minHeight = "";
    } catch (problem) {
      if (!problem.title) throw problem;
      if (turn === this.turn) replace(this.place, problemBox(problem));
    }
  }

  // A record along p(t) has no operating point, and so no frequency response.
  #along(experiment, frequency) {
    const record = h("div", {});
    replace(this.place, h("h2", {}, `At ${significant(hertz(frequency), 4)} Hz`), h("p", { class: "hint" }, "The scheduling varied in this experiment, so that it shows no frequency response of one operating point."), record);
    return recordPlot(record, experiment, this.plant);
  }

  // Responses, measured and of the model, kept for the next time.
  #fetched(id) {
    if (!this.kept.has(id)) this.kept.set(id, this.#fetch(id));
    return this.kept.get(id);
  }

  async #fetch(id) {
    const measured = await get(`/comparisons/${this.comparison.id}/responses/${id}`);
    const band = bandOf(this.model, [...this.experiments.values()]);
    return { id, measured, model: await responseOf(this.model, measured.operatingPoint, band) };
  }

  #title({ id, measured }) {
    const experiment = this.experiments.get(id);
    const name = experiment ? experimentTitle(experiment, this.plant.schedulingVariables) : "experiment";
    return `${DATA[measured.data] === "fitted" ? "Fitted" : "Held out"}: ${name.replace(/^held out: /, "")}`;
  }

  #leftOut(found) {
    const kinds = [...new Set(found.flatMap((one) => one.model.leftOutEffects))];
    if (!kinds.length) return null;
    return h("p", { class: "hint" }, "The model has effects that act on signals. Its curve is that of the linear core; the hollow points are its answer to this very input, and those are what the measurement is compared with.");
  }

  #bode(place, { measured, model }, frequency) {
    const { frequenciesRadPerSecond: frequencies, standardDeviation: deviation } = measured;
    const points = [{ name: "measured", frequencies, response: measured.measured, deviation }];
    if (model.leftOutEffects.length) points.push({ name: "model, this input", frequencies, response: measured.modelled, deviation: null, hollow: true });
    const [input, output] = [this.plant.input?.unit, this.plant.output?.unit];
    return bodePlot(place, {
      curves: [{ name: "model", response: model }], points, mark: frequency, unit: input && output ? `${output}/${input}` : "",
      misfit: { frequencies, size: distance(measured.measured, measured.modelled), noise: deviation },
      caption: "Measured points and model, with bars and bands of 95 %; below, what is left between them, against the noise.", height: 480,
    });
  }
}

const distance = (a, b) => a.re.map((re, i) => Math.hypot(re - b.re[i], a.im[i] - b.im[i]));
