// Plots as PNG, SVG and CSV, tables as CSV: numbers in full and in plain digits, names from what they show.

import { save } from "./api.js";
import { h } from "./dom.js";
import { submitButton } from "./forms.js";
import { colour } from "./theme.js";

const DIGITS = new Map([..."⁰¹²³⁴⁵⁶⁷⁸⁹"].map((sign, digit) => [sign, String(digit)]).concat([["⁻", "-"]]));
const POWER = /^([-\d.]+)·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)$/;

// Buttons under a plot; `draw` gives {data, layout}, `ready` resolves when it has been drawn.
export function plotButtons(chart, { draw, ready, caption }) {
  const drawing = async () => {
    await ready();
    const { width, height } = chart.getBoundingClientRect();
    const address = await globalThis.Plotly.toImage(chart, { format: "svg", width, height });
    return { svg: new Blob([decodeURIComponent(address.slice(address.indexOf(",") + 1))], { type: "image/svg+xml" }), width, height };
  };
  const saved = async (make, format) => save(await make(await drawing()), `${fileName(caption)}.${format}`);
  return buttons(["PNG", () => saved(pngOf, "png")], ["SVG", () => saved(({ svg }) => svg, "svg")], ["CSV", () => saveCsv(curveRows(draw()), caption)]);
}

// A button under a table: all its rows.
export function tableButton({ columns, rows, caption = "" }) {
  return buttons(["CSV", () => saveCsv([columns, ...rows.map((row) => row.map(plain))], caption || columns.join(" "))]);
}

// A picture on a canvas as PNG.
export function canvasButton(canvas, caption) {
  return buttons(["PNG", () => new Promise((resolve) => { canvas.toBlob((blob) => resolve(save(blob, `${fileName(caption)}.png`))); })]);
}

// The drawing in twice as many pixels, on the colour of the page.
async function pngOf({ svg, width, height }) {
  const image = new Image();
  image.src = URL.createObjectURL(svg);
  await image.decode();
  const canvas = Object.assign(document.createElement("canvas"), { width: 2 * width, height: 2 * height });
  const pen = canvas.getContext("2d");
  pen.fillStyle = colour("--page");
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.drawImage(image, 0, 0, canvas.width, canvas.height);
  URL.revokeObjectURL(image.src);
  return new Promise((resolve) => { canvas.toBlob(resolve, "image/png"); });
}

function buttons(...pairs) {
  return h("p", { class: "save" }, "Save as ", pairs.map(([label, action]) => submitButton(label, action, { class: "small quiet" })));
}

function saveCsv(rows, caption) {
  const text = rows.map((row) => row.map(quoted).join(",")).join("\r\n");
  save(new Blob([`\ufeff${text}\r\n`], { type: "text/csv" }), `${fileName(caption)}.csv`);
}

// Every point of every named curve, with what its axes say.
function curveRows({ data, layout }) {
  const title = (trace, letter) => layout[(trace[`${letter}axis`] ?? letter).replace(/^[xy]/, `${letter}axis`)]?.title?.text || letter;
  const shown = data.filter((trace) => trace.x && trace.y && trace.hoverinfo !== "skip");
  return [["curve", "horizontal", "x", "vertical", "y"], ...shown.flatMap((trace) => [...trace.x].map((x, i) => [trace.name ?? "", title(trace, "x"), x, title(trace, "y"), trace.y[i]]))];
}

// A cell as a spreadsheet reads it: 1.2·10⁻³ becomes 1.2e-3.
export function plain(cell) {
  const text = (cell?.textContent ?? String(cell ?? "")).replaceAll("\u00a0", " ");
  const number = text.replaceAll("−", "-");
  const [, mantissa, power] = POWER.exec(number) ?? [];
  if (mantissa) return `${mantissa}e${[...power].map((sign) => DIGITS.get(sign)).join("")}`;
  return /^-[\d.]+$/.test(number) ? number : text;
}

function quoted(cell) {
  const text = String(cell ?? "");
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

// The plant, the page and what is shown, in letters that every file system takes.
function fileName(caption) {
  const said = new Set(["plant-name", "title"].map((id) => document.getElementById(id)?.textContent ?? ""));
  return `${[...said].join(" ")} ${caption}`.normalize("NFKD").replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-+|-+$/g, "").slice(0, 80).replace(/-+$/, "") || "plot";
}
