// A map of values over (operating point, frequency) on a canvas: mouse, touch and keyboard, with legend and table.

import { h, newId } from "./dom.js";
import { Cells } from "./map_cells.js";
import { drawLegend, drawMap, layoutOf, paintCells } from "./map_drawing.js";
import { significant } from "./numbers.js";
import { canvasButton } from "./saving.js";
import { tableBehind } from "./tables.js";
import { onThemeChange } from "./theme.js";

const KEYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], PageUp: [-20, 0], PageDown: [20, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class FieldMap {
  // rows: [{label, frequencies, values}], drawn from the bottom up, values outside [minimum, maximum] in the colours of
  // the ends; kind: "diverging" (the middle of the range is nothing to look at) or "sequential";
  // frequencyTitle: with its unit, in which the frequencies are; valueTitle: what the colours mean;
  // describe(row, column): a cell in words; onChoose(row, column): after a click or Enter; columns count as given.
  constructor(place, { rows, minimum, maximum, kind = "diverging", log = true, height = 0, caption, frequencyTitle, valueTitle, describe, onChoose, table = null }) {
    this.labels = rows.map((row) => row.label);
    this.cells = new Cells(rows, log);
    this.colours = { kind, minimum, maximum };
    this.title = frequencyTitle;
    this.describe = describe;
    this.onChoose = onChoose;
    this.chosen = null;
    this.height = height || Math.min(Math.max(rows.length * 18, 120), 460) + 50;
    this.#build(place, caption, valueTitle, table);
    this.#listen();
    this.#resize();
    onThemeChange(() => this.#resize());
  }

  // Mark a cell, by its row and the column as given, without telling `onChoose`.
  choose(row, column) {
    this.#move(row, this.cells.rows[row].order.indexOf(column));
  }

  #build(place, caption, valueTitle, table) {
    const reading = newId("reading");
    this.canvas = h("canvas", { tabindex: 0, role: "application", "aria-roledescription": "map", "aria-describedby": reading,
      "aria-label": `${caption} Arrow keys move, Enter opens a cell.`, style: `height:${this.height}px` });
    this.legend = h("canvas", { role: "img", "aria-label": `Colours of ${valueTitle}` });
    this.reading = h("p", { class: "map-reading", id: reading, "aria-live": "polite" }, "Choose a cell by mouse, touch or arrow keys.");
    const { minimum, maximum } = this.colours;
    place.append(h("figure", {},
      h("div", { class: "map-legend" }, h("span", {}, valueTitle), h("span", {}, significant(minimum)), this.legend, h("span", {}, significant(maximum))),
      h("div", { class: "map" }, this.canvas), this.reading, h("figcaption", {}, caption), canvasButton(this.canvas, caption), table && tableBehind(table)));
  }

  #listen() {
    this.canvas.addEventListener("click", (event) => {
      const [row, cell] = this.#at(event.offsetX, event.offsetY);
      if (cell >= 0) this.#move(row, cell, true);
    });
    this.canvas.addEventListener("keydown", (event) => this.#key(event));
    new ResizeObserver(() => this.#resize()).observe(this.canvas);
  }

  #key(event) {
    const { row, cell } = this.chosen ?? { row: 0, cell: 0 };
    if (event.key === "Enter" || event.key === " ") this.#move(row, cell, true);
    else if (event.key === "Home") this.#move(row, 0);
    else if (event.key === "End") this.#move(row, this.cells.rows[row].count - 1);
    else if (event.key in KEYS) this.#step(row, cell, ...KEYS[event.key]);
    else return;
    event.preventDefault();
  }

  #step(row, cell, right, up) {
    const next = Math.min(Math.max(row + up, 0), this.labels.length - 1);
    const place = this.cells.coordinate(this.cells.frequency(row, cell));
    const moved = Math.min(Math.max(cell + right, 0), this.cells.rows[next].count - 1);
    this.#move(next, up ? this.cells.nearest(next, place) : moved);
  }

  #at(x, y) {
    const { left, top, width, height } = this.place;
    const rows = this.labels.length;
    const row = Math.min(Math.max(Math.floor((1 - (y - top) / height) * rows), 0), rows - 1);
    const coordinate = this.cells.low + ((x - left) / width) * (this.cells.high - this.cells.low);
    return [row, this.cells.nearest(row, coordinate)];
  }

  #move(row, cell, tell = false) {
    if (cell < 0 || cell >= this.cells.rows[row].count) return;
    this.chosen = { row, cell };
    const column = this.cells.rows[row].order[cell];
    this.reading.textContent = this.describe(row, column);
    this.#draw();
    if (tell) this.onChoose?.(row, column);
  }

  #resize() {
    const width = this.canvas.clientWidth;
    if (!width) return;
    this.canvas.width = Math.round(width * devicePixelRatio);
    this.canvas.height = Math.round(this.height * devicePixelRatio);
    this.place = layoutOf(this.canvas, this.labels, width, this.height);
    const rowHeight = Math.max(Math.round((this.place.height * devicePixelRatio) / Math.max(this.labels.length, 1)), 1);
    this.picture = paintCells(this.cells, this.colours, this.place.width * devicePixelRatio, rowHeight);
    drawLegend(this.legend, this.colours.kind);
    this.#draw();
  }

  #draw() {
    if (!this.place) return; // not laid out yet; then #resize draws
    drawMap(this.canvas, this);
  }
}
