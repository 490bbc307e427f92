// The cells of a map: rows of values at frequencies of their own, on a common horizontal axis. Nothing is drawn here.

export class Cells {
  // rows: [{frequencies, values}]; each row is sorted by frequency; `order` leads back to the places given.
  constructor(rows, log) {
    const lowest = Math.min(...rows.flatMap((row) => lowestPositive(row.frequencies)));
    this.log = log && Number.isFinite(lowest);
    // Zero has no logarithm: it stands one step below the lowest frequency.
    this.zero = Math.log10(lowest) - 0.15;
    this.rows = rows.map((row) => this.#row(row));
    this.low = Math.min(...this.rows.flatMap((row) => (row.edges.length ? [row.edges[0]] : [])));
    this.high = Math.max(...this.rows.flatMap((row) => (row.edges.length ? [row.edges.at(-1)] : [])));
    if (!(this.high > this.low)) [this.low, this.high] = [0, 1];
    this.hasZero = this.log && rows.some((row) => row.frequencies.includes(0));
  }

  // Where a frequency stands on the axis.
  coordinate(frequency) {
    if (!this.log) return frequency;
    return frequency > 0 ? Math.log10(frequency) : this.zero;
  }

  // The cell of a row at a place of the axis, or the nearest one; -1 in an empty row.
  nearest(rowIndex, place) {
    const { edges, count } = this.rows[rowIndex];
    let [left, right] = [0, count - 1];
    while (left < right) {
      const middle = (left + right) >> 1;
      if (place < edges[middle + 1]) right = middle;
      else left = middle + 1;
    }
    return count ? left : -1;
  }

  frequency(rowIndex, cell) {
    return this.rows[rowIndex].frequencies[cell];
  }

  value(rowIndex, cell) {
    return this.rows[rowIndex].values[cell];
  }

  // For each of `width` pixels of a row the value furthest from `centre`; NaN where there is no cell.
  strip(rowIndex, width, centre) {
    const { edges, values, count } = this.rows[rowIndex];
    const strip = new Float64Array(width).fill(NaN);
    const pixels = width / (this.high - this.low);
    for (let cell = 0; cell < count; cell += 1) {
      const first = Math.max(Math.floor((edges[cell] - this.low) * pixels), 0);
      const last = Math.min(Math.max(Math.ceil((edges[cell + 1] - this.low) * pixels), first + 1), width);
      for (let pixel = first; pixel < last; pixel += 1) {
        if (!(Math.abs(strip[pixel] - centre) >= Math.abs(values[cell] - centre))) strip[pixel] = values[cell];
      }
    }
    return strip;
  }

  #row({ frequencies, values }) {
    const order = frequencies.map((_, index) => index).sort((a, b) => frequencies[a] - frequencies[b]);
    const places = order.map((index) => this.coordinate(frequencies[index]));
    return {
      order, edges: edgesOf(places, this.log), count: order.length,
      frequencies: order.map((index) => frequencies[index]), values: order.map((index) => values[index]),
    };
  }
}

// Half-way between neighbours; the outermost cells are as wide as their inner halves.
function edgesOf(places, log) {
  const count = places.length;
  if (!count) return [];
  if (count === 1) return [places[0] - (log ? 0.05 : 0.5), places[0] + (log ? 0.05 : 0.5)];
  const inner = places.slice(1).map((place, index) => (place + places[index]) / 2);
  return [2 * places[0] - inner[0], ...inner, 2 * places[count - 1] - inner[count - 2]];
}

function lowestPositive(frequencies) {
  return frequencies.reduce((least, one) => (one > 0 && one < least ? one : least), Infinity);
}

// Places and labels of ticks between two places of the axis.
export function ticks(low, high, log) {
  return log ? logarithmicTicks(low, high) : linearTicks(low, high);
}

function linearTicks(low, high) {
  const rough = (high - low) / 6;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => one >= rough);
  const first = Math.ceil(low / step);
  return Array.from({ length: Math.floor(high / step) - first + 1 }, (_, index) => {
    const place = (first + index) * step;
    return { place, label: Number(place.toPrecision(6)).toString() };
  });
}

function logarithmicTicks(low, high) {
  const factors = high - low > 3 ? [1] : high - low > 1.2 ? [1, 3] : [1, 2, 3, 5, 7];
  const found = [];
  for (let decade = Math.floor(low); decade <= high; decade += 1) {
    for (const factor of factors) {
      const place = decade + Math.log10(factor);
      if (place >= low && place <= high) found.push({ place, label: Number((factor * 10 ** decade).toPrecision(3)).toString() });
    }
  }
  return found;
}
