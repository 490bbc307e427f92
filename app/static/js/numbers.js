// Numbers as a reader wants them: as many digits as they are worth, with their unit; null is "not known".

const UNKNOWN = "not known";
const SUPERSCRIPTS = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

// A number to so many significant digits, without an exponent between 10⁻⁴ and 10⁶.
export function significant(value, digits = 3) {
  if (value == null || !Number.isFinite(value)) return UNKNOWN;
  if (value === 0) return "0";
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  const magnitude = Number(exponent);
  if (magnitude < -4 || magnitude >= 6) return `${mantissa}·10${superscript(magnitude)}`.replace(/^-/, "−");
  return value.toFixed(Math.max(digits - 1 - magnitude, 0)).replace("-", "−");
}

// The same with a unit, which may be "".
export function quantity(value, unit, digits = 3) {
  const text = significant(value, digits);
  return text === UNKNOWN || !named(unit) ? text : `${text}\u00a0${unit}`;
}

// Whether a unit is more than that of a mere number.
const named = (unit) => Boolean(unit) && unit !== "1";

// A number that was stated, with the digits that it was stated with; with its unit.
export function exact(value, unit = "") {
  if (value == null) return UNKNOWN;
  const text = /e/.test(String(Number(value.toPrecision(6)))) ? significant(value, 4) : String(Number(value.toPrecision(6)));
  return `${text.replace("-", "−")}${named(unit) ? `\u00a0${unit}` : ""}`;
}

// A size in memory.
export function bytes(count) {
  if (count < 1024) return `${count}\u00a0bytes`;
  return count < 1024 ** 2 ? quantity(count / 1024, "KiB") : quantity(count / 1024 ** 2, "MiB");
}

// Value ± standard deviation, the latter to two significant digits and the former to the same place.
export function estimate(value, deviation, unit = "") {
  if (!(deviation > 0)) return quantity(value, unit);
  const magnitude = Math.floor(Math.log10(Number(deviation.toPrecision(2))));
  const large = Math.floor(Math.log10(Math.max(Math.abs(value), deviation)));
  if (large < -4 || large >= 6) return `${significant(value)} ± ${significant(deviation, 2)} ${unit}`.trim();
  const places = Math.max(1 - magnitude, 0);
  return `${value.toFixed(places)} ± ${deviation.toFixed(places)} ${unit}`.trim().replaceAll("-", "−");
}

// A share as a percentage.
export function percent(share, digits = 3) {
  return share == null ? UNKNOWN : `${significant(100 * share, digits)} %`;
}

export function probability(p) {
  if (p == null) return UNKNOWN;
  return p < 1e-4 ? "below 0.0001" : significant(p, 2);
}

export const hertz = (radPerSecond) => radPerSecond / (2 * Math.PI);
export const radPerSecond = (inHertz) => 2 * Math.PI * inHertz;

// An operating point in words: names and units come from the scheduling variables of the plant.
export function pointLabel(point, variables) {
  return point.map((value, i) => `${variables[i].name} = ${exact(Number(value.toPrecision(4)), variables[i].unit)}`).join(", ");
}

export function duration(seconds) {
  if (seconds == null) return UNKNOWN;
  if (seconds < 120) return quantity(seconds, "s");
  return seconds < 7200 ? quantity(seconds / 60, "min") : quantity(seconds / 3600, "h");
}

// A moment of the server in the reader's time zone.
export function moment(text) {
  return text ? new Date(text).toLocaleString(undefined, { dateStyle: "medium", timeStyle: "short" }) : UNKNOWN;
}

// A name with its unit in brackets, for axes and heads.
export function labelled(name, unit) {
  return named(unit) ? `${name} (${unit})` : name;
}

// Of some things: 1 job, 2 jobs.
export function counted(count, one, many = `${one}s`) {
  return `${count} ${count === 1 ? one : many}`;
}

function superscript(number) {
  return String(number).replace(/[-0-9]/g, (sign) => SUPERSCRIPTS[sign]);
}
