// Plots by plotly.js in the colours of the page, each with a caption and the numbers behind it.

import { context } from "./context.js";
import { h } from "./dom.js";
import { begin, whenNear } from "./near_window.js";
import { seriesColour } from "./palette.js";
import { plotButtons } from "./saving.js";
import { tableBehind } from "./tables.js";
import { colour, onThemeChange } from "./theme.js";

const SETTINGS = { responsive: true, displayModeBar: false, scrollZoom: false, doubleClick: "reset" };
const drawn = new Map(); // of each chart: draws it again
const drawings = new WeakMap(); // of each chart: resolves when it has been drawn
let loading = null;

// A plot in `place`, drawn when it comes near the window. `draw` gives {data, layout} anew for every theme; `table` gives
// what `table()` takes. Data are zoomed by dragging where there is a mouse; a double click shows all again. Gives the
// element that plotly.js draws into.
export function plot(place, { draw, caption, table = null, height = 340, label = caption }) {
  const chart = h("div", { class: "plot", role: "img", "aria-label": label, style: `height:${height}px` });
  const saving = plotButtons(chart, { draw, caption, ready: () => begin(chart) });
  place.append(h("figure", {}, chart, h("figcaption", {}, caption), saving, table && tableBehind(table)));
  const render = () => {
    const { data, layout } = draw();
    const shown = styled(layout, height, data);
    return globalThis.Plotly.react(chart, data.map((trace) => withHover(trace, shown)), shown, SETTINGS);
  };
  drawings.set(chart, whenNear(chart, async () => {
    await loadPlotly();
    await render();
    drawn.set(chart, render);
  }));
  return chart;
}

// Zooming one of the charts zooms the others along the named axes, e.g. "xaxis".
export function linkAxes(charts, names = ["xaxis"]) {
  let busy = false;
  const follow = async (leader, change) => {
    const relevant = Object.entries(change).filter(([key]) => names.includes(key.split(".")[0]));
    if (busy || !relevant.length) return;
    busy = true;
    const others = charts.filter((chart) => chart !== leader);
    await Promise.all(others.map(begin));
    await Promise.all(others.map((other) => globalThis.Plotly.relayout(other, Object.fromEntries(relevant))));
    busy = false;
  };
  for (const chart of charts) drawings.get(chart).then(() => chart.on("plotly_relayout", (change) => follow(chart, change)));
}

// An axis: logarithmic or linear, with a title.
export function axis(title, { log = false, ...more } = {}) {
  return { title: { text: title }, type: log ? "log" : "linear", ...(log ? { exponentformat: "power" } : {}), ...more };
}

// At most `most` points of a long curve that look the same: the smallest and largest of each stretch.
export function thinned(x, y, most = 4000) {
  if (x.length <= most) return { x, y };
  const stretch = Math.ceil((2 * x.length) / most);
  const kept = [];
  for (let start = 0; start < x.length; start += stretch) {
    let [low, high] = [start, start];
    for (let i = start; i < Math.min(start + stretch, x.length); i += 1) {
      if (y[i] < y[low]) low = i;
      if (y[i] > y[high]) high = i;
    }
    kept.push(...(low === high ? [low] : [Math.min(low, high), Math.max(low, high)]));
  }
  return { x: kept.map((i) => x[i]), y: kept.map((i) => y[i]) };
}

export function loadPlotly() {
  loading ??= new Promise((resolve, reject) => {
    const script = h("script", { src: context.plotly, onload: resolve, onerror: () => reject(new Error("plotly.js did not load")) });
    document.head.append(script);
  });
  return loading;
}

function styled(layout, height, data) {
  const line = { automargin: true, showline: true, linecolor: colour("--edge"), gridcolor: colour("--line"), zeroline: false, ticks: "outside", tickcolor: colour("--edge") };
  const result = {
    height,
    margin: { l: 12, r: 12, t: 28, b: 12 },
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: "rgba(0,0,0,0)",
    font: { family: "system-ui, sans-serif", size: 13, color: colour("--ink") },
    hoverlabel: { bgcolor: colour("--panel"), bordercolor: colour("--edge"), font: { color: colour("--ink") } },
    colorway: [0, 1, 2, 3, 4, 5].map(seriesColour),
    legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom" },
    hovermode: "closest",
    dragmode: matchMedia("(pointer: fine)").matches ? "zoom" : false,
    ...layout,
  };
  for (const name of Object.keys(result).filter((key) => /^[xy]axis\d*$/.test(key))) {
    const ticks = result[name].type === "log" ? logarithmicStep(data, name) : {};
    result[name] = { ...line, ...ticks, ...roomForConstant(data, name, result[name]), ...result[name], title: { standoff: 10, ...result[name].title } };
  }
  return result;
}

// What a point says when pointed at: both numbers under the titles of their axes, which carry the units.
function withHover(trace, layout) {
  if (trace.hovertemplate || trace.hoverinfo || ["heatmap", "bar"].includes(trace.type)) return trace;
  const said = ["x", "y"].map((letter) => {
    const title = layout[(trace[`${letter}axis`] ?? letter).replace(/^[xy]/, `${letter}axis`)]?.title?.text || letter;
    return `${title}: %{${letter}${typeof trace[letter]?.[0] === "number" ? ":.4~g" : ""}}`;
  });
  return { ...trace, hovertemplate: `${said.join("<br>")}<extra>${trace.name ?? ""}</extra>` };
}

// The least and the largest number along an axis.
function extent(data, name) {
  const [, letter, number] = /^([xy])axis(\d*)$/.exec(name);
  const own = data.filter((trace) => (trace[`${letter}axis`] ?? letter) === letter + number);
  const values = own.flatMap((trace) => [...(trace[letter] ?? [])]).filter((one) => typeof one === "number" && Number.isFinite(one));
  return (positive) => values.filter((one) => !positive || one > 0).reduce(([least, most], one) => [Math.min(least, one), Math.max(most, one)], [Infinity, -Infinity]);
}

// At most some eight ticks: whole decades, or 1, 2 and 5 where there are few; plotly.js knows best within half a decade.
function logarithmicStep(data, name) {
  const [low, high] = extent(data, name)(true);
  const decades = Math.log10(high / low);
  if (!(decades > 0.7)) return {};
  return { dtick: decades > 1.5 ? Math.ceil(decades / 8) : "D2" };
}

// Values that are all the same, but for rounding, stand in the middle of an axis of about their size.
function roomForConstant(data, name, axis) {
  if (axis.range || axis.rangemode || !["log", "linear"].includes(axis.type)) return {};
  const log = axis.type === "log";
  const [low, high] = extent(data, name)(log);
  if (!(high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high)))) return {};
  if (log) return { range: [Math.log10(low) - 0.5, Math.log10(low) + 0.5] };
  const half = Math.abs(low) / 2 || 1;
  return { range: [low - half, low + half] };
}

onThemeChange(() => {
  for (const [chart, render] of drawn) {
    if (chart.isConnected) render();
    else drawn.delete(chart);
  }
});
