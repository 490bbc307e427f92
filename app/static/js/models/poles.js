// Poles over the scheduling variable, as natural frequency and damping.

import { hertz, labelled, significant } from "../numbers.js";
import { dash, seriesColour, symbol } from "../palette.js";
import { axis, plot } from "../plots.js";

// Draw the poles of a model [{operatingPoint, poles}] of a plant with one scheduling variable.
export function polesPlot(place, model, variable) {
  const step = model.structure.sampleTimeSeconds ?? null;
  const rows = model.poles.flatMap(({ operatingPoint: [p], poles }) => poles.re.map((re, i) => ({ p, re, im: poles.im[i], ...naturalOf(re, poles.im[i], step) })))
    .filter((one) => one.im >= 0);
  const title = labelled(variable.name, variable.unit);
  const trace = (key, yaxis, i) => ({ x: rows.map((one) => one.p), y: rows.map((one) => one[key]), yaxis, mode: "markers", showlegend: false, marker: { size: 5, color: seriesColour(i), symbol: symbol(i) }, line: { dash: dash(0) } });
  return plot(place, {
    caption: "Natural frequency and damping of the poles over the range.", height: 380,
    draw: () => ({ data: [trace("frequency", "y", 0), trace("damping", "y2", 1)], layout: {
      xaxis: axis(title, { anchor: "y2" }), yaxis: axis("frequency (Hz)", { domain: [0.54, 1], rangemode: "tozero" }), yaxis2: axis("damping ratio", { domain: [0, 0.46], rangemode: "tozero" }) } }),
    table: () => ({ columns: [title, step ? "pole (z-plane)" : "pole (rad/s)", "natural frequency (Hz)", "damping ratio"], textColumns: 2,
      rows: rows.map((one) => [significant(one.p), poleText(one), significant(one.frequency), significant(one.damping)]) }),
  });
}

// In continuous time s; in discrete time s = ln(z)/T.
function naturalOf(re, im, step) {
  const [sRe, sIm] = step ? [Math.log(Math.hypot(re, im)) / step, Math.atan2(im, re) / step] : [re, im];
  const size = Math.hypot(sRe, sIm);
  return { frequency: hertz(size), damping: size > 0 ? -sRe / size : 1 };
}

const poleText = ({ re, im }) => (im === 0 ? significant(re) : `${significant(re)} ± ${significant(im)} j`);
