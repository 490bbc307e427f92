// Energy against accuracy: the same design with every target looser or stricter by a factor.

import { get, list, post } from "../api.js";
import { h, replace } from "../dom.js";
import { submitButton } from "../forms.js";
import { jobCard } from "../jobs.js";
import { labelled, significant } from "../numbers.js";
import { axis, plot } from "../plots.js";
import { problemBox } from "../problems.js";
import { energyUnit } from "./spectra.js";

const FACTORS = [0.5, 0.7, 1.4, 2, 4];
const NAME = /^accuracy × ([\d.]+) of ([0-9a-f]{32})$/;

// Whether a design was made for such a curve.
export const isTrial = (design) => NAME.test(design.request.name);

export async function drawTrade(place, plant, design) {
  const all = await list("/designs", { plantId: plant.id }, 500);
  const trials = all.filter((one) => NAME.exec(one.request.name)?.[2] === design.id);
  replace(place, h("h2", {}, "Energy against accuracy"), h("p", {}, "What it would cost to know the plant better, or how much could be saved by knowing it less well: the same request with all deviations multiplied by a factor."));
  if (trials.length) drawCurve(place, plant, design, trials);
  else if (scaled(design.request.targets, 1)) place.append(h("p", { class: "actions" }, submitButton("Compute the trade", () => compute(place, plant, design), { class: "quiet" })));
  else place.append(h("p", { class: "hint" }, "These targets have no common scale."));
}

async function compute(place, plant, design) {
  const progress = h("div", {});
  place.append(progress);
  await Promise.all(FACTORS.map(async (factor) => {
    const request = { ...design.request, name: `accuracy × ${factor} of ${design.id}`, targets: scaled(design.request.targets, factor) };
    try {
      const card = jobCard(await post("/designs", request));
      progress.append(card.element);
      const ended = await card.ended;
      if (ended.state === "succeeded") card.element.remove();
    } catch (problem) {
      progress.append(problemBox(problem));
    }
  }));
  await drawTrade(place, plant, await get(`/designs/${design.id}`));
  place.append(progress);
}

function drawCurve(place, plant, design, trials) {
  const points = [[1, design], ...trials.map((one) => [Number(NAME.exec(one.request.name)[1]), one])];
  const reached = points.filter(([, one]) => one.totalEnergy != null).sort(([a], [b]) => a - b);
  const infeasible = points.filter(([, one]) => one.totalEnergy == null).map(([factor]) => `× ${factor}`);
  const note = infeasible.length ? ` Not to be reached within the limits: ${infeasible.join(", ")}.` : "";
  const unit = energyUnit(plant);
  return plot(place, {
    caption: `Least energy over the deviations that are allowed, as a multiple of those asked for.${note}`, height: 300,
    draw: () => ({
      data: [
        { x: reached.map(([factor]) => factor), y: reached.map(([, one]) => one.totalEnergy), name: "energy", mode: "lines+markers", marker: { size: 9 } },
        { x: reached.map(([factor]) => factor), y: reached.map(([, one]) => one.lowerBound), name: "no design needs less", mode: "lines", line: { dash: "dot" } },
      ],
      layout: { xaxis: axis("allowed deviation, × what was asked for", { log: true, tickvals: reached.map(([factor]) => factor), ticktext: reached.map(([factor]) => String(factor)) }), yaxis: axis(labelled("energy Σu²", unit), { log: true }), showlegend: true },
    }),
    table: () => ({ columns: ["deviation ×", labelled("energy", unit), "no design needs less than"], rows: reached.map(([factor, one]) => [String(factor), significant(one.totalEnergy, 4), significant(one.lowerBound, 4)]) }),
  });
}

// The targets with their deviations multiplied; null when one of them has none.
function scaled(targets, factor) {
  const results = targets.map((target) => {
    const parts = Object.entries(target).map(([name, value]) => [name, /deviations?$/i.test(name) ? times(value, factor) : name === "covariance" ? times(value, factor ** 2) : value]);
    return parts.some(([name]) => /deviations?$|^covariance$/i.test(name)) ? Object.fromEntries(parts) : null;
  });
  return results.includes(null) ? null : results;
}

function times(value, factor) {
  if (Array.isArray(value)) return value.map((one) => times(one, factor));
  return typeof value === "number" ? value * factor : value;
}
