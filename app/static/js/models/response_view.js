// The frequency responses of models at an operating point that can be chosen, beside each other on linked axes.

import { bodePlot } from "../bode.js";
import { h, replace } from "../dom.js";
import { field, select } from "../forms.js";
import { pointLabel } from "../numbers.js";
import { linkAxes } from "../plots.js";
import { problemBox } from "../problems.js";
import { bandOf, responseOf } from "./responses.js";

export class ResponseView {
  // models: [[title, model], …]; points: operating points to choose from.
  constructor(place, { plant, points, experiments, models }) {
    Object.assign(this, { plant, points, experiments, models });
    this.chooser = select(points.map((point, i) => [i, pointLabel(point, plant.schedulingVariables)]), Math.floor(points.length / 2));
    this.chooser.addEventListener("change", () => this.show());
    this.inner = h("div", {});
    replace(place, h("div", { class: "fields" }, field("operating point", this.chooser)), this.inner);
  }

  // Draw the models again, others when they are given.
  async show(models = this.models) {
    this.models = models;
    const point = this.points[Number(this.chooser.value)];
    try {
      const responses = await Promise.all(models.map(([, model]) => responseOf(model, point, bandOf(model, this.experiments))));
      const columns = models.map(([title]) => h("div", {}, models.length > 1 ? h("h3", {}, title) : null));
      replace(this.inner, h("div", { class: models.length > 1 ? "columns" : "" }, columns), leftOut(responses));
      const charts = responses.map((one, i) => this.#draw(columns[i], one));
      if (charts.length > 1) linkAxes(charts, ["xaxis", "yaxis", "yaxis2"]);
    } catch (problem) {
      if (!problem.title) throw problem;
      replace(this.inner, problemBox(problem));
    }
  }

  #draw(place, response) {
    const [input, output] = [this.plant.input?.unit, this.plant.output?.unit];
    return bodePlot(place, { curves: [{ name: "model", response }], points: [], unit: input && output ? `${output}/${input}` : "",
      caption: `The model at ${pointLabel(response.operatingPoint, this.plant.schedulingVariables)}${response.magnitudeLower95 ? "; band: 95 %" : ""}.` });
  }
}

function leftOut(responses) {
  const some = responses.some((one) => one.leftOutEffects.length);
  return some ? h("p", { class: "hint" }, "Effects that act on signals are no part of a frequency response; shown is the linear core.") : null;
}
