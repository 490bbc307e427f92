// How a map of cells is drawn on a canvas: coloured strips, axes, the chosen cell.

import { ticks } from "./map_cells.js";
import { scale } from "./palette.js";
import { colour } from "./theme.js";

const FONT = "12px system-ui, sans-serif";
const BOTTOM = 42;
const TOP = 8;
const RIGHT = 10;

// Where things stand for a canvas of this size in CSS pixels.
export function layoutOf(canvas, labels, width, height) {
  const pen = canvas.getContext("2d");
  pen.font = FONT;
  const widest = Math.max(...labels.map((label) => pen.measureText(label).width), 0);
  const left = Math.min(widest, 0.34 * width) + 14;
  return { left, top: TOP, width: Math.max(width - left - RIGHT, 10), height: Math.max(height - TOP - BOTTOM, 10) };
}

// The coloured strips as a picture of their own, so that moving the chosen cell does not make them anew.
export function paintCells(cells, { kind, minimum, maximum }, width, rowHeight) {
  const picture = document.createElement("canvas");
  const rows = cells.rows.length;
  picture.width = Math.max(Math.round(width), 1);
  picture.height = Math.max(rows * rowHeight, 1);
  const image = new ImageData(picture.width, picture.height);
  const colours = scale(kind);
  const centre = kind === "diverging" ? (minimum + maximum) / 2 : minimum;
  for (let row = 0; row < rows; row += 1) {
    const line = lineOf(cells.strip(row, picture.width, centre), colours, minimum, maximum);
    for (let y = 0; y < rowHeight; y += 1) image.data.set(line, ((rows - 1 - row) * rowHeight + y) * picture.width * 4);
  }
  picture.getContext("2d").putImageData(image, 0, 0);
  return picture;
}

function lineOf(strip, colours, minimum, maximum) {
  const line = new Uint8ClampedArray(strip.length * 4);
  for (let pixel = 0; pixel < strip.length; pixel += 1) {
    if (Number.isNaN(strip[pixel])) continue;
    const share = (strip[pixel] - minimum) / (maximum - minimum);
    const [red, green, blue] = colours[Math.round(255 * Math.min(Math.max(share, 0), 1))];
    line.set([red, green, blue, 255], 4 * pixel);
  }
  return line;
}

export function drawMap(canvas, { cells, picture, place, labels, title, chosen }) {
  const pen = canvas.getContext("2d");
  pen.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
  pen.clearRect(0, 0, canvas.width, canvas.height);
  pen.imageSmoothingEnabled = false;
  pen.drawImage(picture, place.left, place.top, place.width, place.height);
  pen.font = FONT;
  pen.fillStyle = colour("--ink");
  pen.strokeStyle = colour("--edge");
  pen.strokeRect(place.left, place.top, place.width, place.height);
  drawFrequencies(pen, cells, place, title);
  drawLabels(pen, labels, place);
  if (chosen) drawChosen(pen, cells, place, chosen);
}

export function horizontal(cells, place, coordinate) {
  return place.left + ((coordinate - cells.low) / (cells.high - cells.low)) * place.width;
}

function drawFrequencies(pen, cells, place, title) {
  const bottom = place.top + place.height;
  let free = -Infinity;
  pen.textAlign = "center";
  const zero = cells.hasZero ? [{ place: cells.zero, label: "0" }] : [];
  for (const tick of [...zero, ...ticks(cells.low, cells.high, cells.log)]) {
    const x = horizontal(cells, place, tick.place);
    const half = pen.measureText(tick.label).width / 2 + 4;
    pen.fillRect(x, bottom, 1, 5);
    if (x - half < free) continue;
    pen.fillText(tick.label, x, bottom + 17);
    free = x + half;
  }
  pen.fillText(title, place.left + place.width / 2, bottom + 35);
}

function drawLabels(pen, labels, place) {
  const step = place.height / labels.length;
  const every = Math.ceil(15 / step);
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  labels.forEach((label, row) => {
    if (row % every === 0) pen.fillText(label, place.left - 6, place.top + place.height - (row + 0.5) * step, place.left - 8);
  });
  pen.textBaseline = "alphabetic";
}

function drawChosen(pen, cells, place, { row, cell }) {
  const { edges } = cells.rows[row];
  const step = place.height / cells.rows.length;
  const left = horizontal(cells, place, edges[cell]);
  const width = Math.max(horizontal(cells, place, edges[cell + 1]) - left, 4);
  const top = place.top + place.height - (row + 1) * step;
  pen.lineWidth = 4;
  pen.strokeStyle = colour("--page");
  pen.strokeRect(left - 1, top, width + 2, step);
  pen.lineWidth = 2;
  pen.strokeStyle = colour("--ink");
  pen.strokeRect(left - 1, top, width + 2, step);
  pen.lineWidth = 1;
}

// The colours of the scale from left to right.
export function drawLegend(canvas, kind) {
  const colours = scale(kind);
  canvas.width = colours.length;
  canvas.height = 1;
  canvas.getContext("2d").putImageData(new ImageData(new Uint8ClampedArray(colours.flatMap((one) => [...one, 255])), colours.length, 1), 0, 0);
}
