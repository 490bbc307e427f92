// A live picture of the functions of a basis: curves over one variable, a map over two.

import { ApiProblem, post } from "./api.js";
import { h, replace } from "./dom.js";
import { field, select } from "./forms.js";
import { FieldMap } from "./map.js";
import { exact, labelled, significant } from "./numbers.js";
import { dash } from "./palette.js";
import { axis, plot } from "./plots.js";

const PAUSE = 300; // milliseconds without a change

export class BasisPicture {
  constructor(place) {
    this.place = place;
    this.asked = 0;
  }

  // Draw the basis of a request soon; a request that cannot be drawn says why in words.
  show(request) {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.#draw(request), PAUSE);
  }

  async #draw(request) {
    this.asked += 1;
    const turn = this.asked;
    try {
      const found = await post("/bases/values", request);
      if (turn === this.asked) draw(this.place, request.schedulingVariables, found);
    } catch (error) {
      if (!(error instanceof ApiProblem)) throw error;
      if (turn === this.asked) replace(this.place, h("p", { class: "hint" }, `No picture yet: ${error.detail}`));
    }
  }
}

function draw(place, variables, found) {
  const many = `${found.functions.length} functions: each coefficient has as many parameters, and needs as many operating points.`;
  replace(place, h("p", { class: "hint" }, many));
  if (variables.length === 1) drawCurves(place, variables[0], found);
  else drawMap(place, variables, found);
}

function drawCurves(place, variable, { axes, functions }) {
  const title = labelled(variable.name, variable.unit);
  return plot(place, {
    caption: "What the basis spans: a coefficient can be any sum of these curves.",
    height: 280,
    draw: () => ({
      data: functions.map((one, i) => ({ x: axes[0], y: one.values, name: `f${one.label}`, mode: "lines", line: { dash: dash(i), width: 2.2 } })),
      layout: { xaxis: axis(title), yaxis: axis("value"), showlegend: functions.length < 12 },
    }),
    table: () => ({ columns: [title, ...functions.map((one) => `f${one.label}`)],
      rows: axes[0].map((value, i) => [significant(value), ...functions.map((one) => significant(one.values[i]))]) }),
  });
}

// The first two variables; further ones stay at their least value.
function drawMap(place, variables, { axes, functions }) {
  const stride = axes.slice(2).reduce((product, one) => product * one.length, 1);
  const inner = h("div", {});
  const show = (index) => {
    const { values } = functions[index];
    const most = Math.max(...values.map(Math.abs), 1e-300);
    const at = (i, j) => values[(i * axes[1].length + j) * stride];
    replace(inner);
    new FieldMap(inner, {
      rows: axes[1].map((value, j) => ({ label: exact(value), frequencies: axes[0], values: axes[0].map((_, i) => at(i, j)) })),
      minimum: -most, maximum: most, log: false, height: 260, valueTitle: "value",
      caption: `Function ${functions[index].label} over ${variables[0].name} and, upwards, ${variables[1].name}.`,
      frequencyTitle: labelled(variables[0].name, variables[0].unit),
      describe: (j, i) => `${variables[0].name} = ${significant(axes[0][i])}, ${variables[1].name} = ${significant(axes[1][j])}: ${significant(at(i, j))}`,
    });
  };
  const chooser = select(functions.map((one, index) => [index, `f${one.label}`]), functions.length - 1);
  chooser.addEventListener("change", () => show(Number(chooser.value)));
  place.append(field("function to look at", chooser), inner);
  show(functions.length - 1);
}
