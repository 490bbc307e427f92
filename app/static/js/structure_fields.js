// The model structure: orders of a rational model in discrete or continuous time, or the coefficients of physics.

import { h, replace } from "./dom.js";
import { checkbox, field, fields, integerInput, numberInput, numberOf, select, textInput } from "./forms.js";

const ORDERS = {
  discrete: [
    ["na", "poles", "na: order of A = 1 + a1 q + …, q the delay by one sample", 2],
    ["nb", "order of the numerator", "nb: b0 + b1 q + … + b_nb q^nb", 1],
    ["nk", "samples of delay", "nk: 1 when the output answers one sample later", 1],
    ["nc", "order of the noise's numerator", "nc: of C in y = (B/A) u + (C/D) e", 0],
    ["nd", "order of the noise's denominator", "nd: of D; 0 for white noise", 0],
  ],
  continuous: [
    ["na", "poles", "na: order of A = x^na + a1 x^(na−1) + …, x = jω over the scale", 2],
    ["nb", "order of the numerator", "nb: b0 x^nb + … + b_nb", 0],
  ],
  continuousPhysical: [],
};
const SIDES = [
  ["denominator", "coefficients of the output's derivatives", "the highest first, as J [kg m2], d [N m s]; exactly one of all coefficients known, as k = 0.5", "J [kg m2], d [N m s]"],
  ["numerator", "coefficients of the input's derivatives", "the highest first", "k [N m/A] = 1"],
];

// {element, value(), coefficients()}; `onChange` when anything has changed; `given`: a structure to begin with.
export function structureFields(onChange, given = null) {
  const domain = select([["continuous", "continuous time"], ["continuousPhysical", "continuous time, coefficients of physics"], ["discrete", "discrete time"]], given?.timeDomain ?? "continuous");
  const place = h("div", { class: "fields wide" });
  let inputs = {};
  const first = (name, start) => given?.[name] ?? start;
  const draw = () => {
    const orders = ORDERS[domain.value].map(([name, label, hint, start]) => [name, label, hint, integerInput(first(name, start), { min: 0 })]);
    const scale = domain.value === "discrete"
      ? ["sampleTimeSeconds", "sample time (s)", "of the records and of the model", numberInput(first("sampleTimeSeconds", 1), { min: 0 })]
      : ["frequencyScaleRadPerSecond", "frequency scale (rad/s)", "a frequency in the middle of the data; coefficients are scaled by it", numberInput(first("frequencyScaleRadPerSecond", 1), { min: 0 })];
    const delay = ["delay", "estimate a delay", "a further coefficient tau, in seconds", checkbox(first("delay", false))];
    const sides = domain.value === "continuousPhysical" ? SIDES.map(([name, label, hint, start]) => [name, label, hint, textInput(given?.[name] ? given[name].map(coefficientText).join(", ") : start)]) : [];
    const all = [...orders, ...sides, scale, delay];
    inputs = Object.fromEntries(all.map(([name, , , input]) => [name, input]));
    replace(place, all.map(([name, label, hint, input]) => field(label, input, { hint, pointer: `/structure/${name}` })));
  };
  domain.addEventListener("change", draw);
  draw();
  const read = (input) => (input.type === "checkbox" ? input.checked : input.type === "text" ? coefficientsIn(input.value) : numberOf(input));
  const value = () => ({ timeDomain: domain.value, ...Object.fromEntries(Object.entries(inputs).map(([name, input]) => [name, read(input)])) });
  const element = h("div", { onchange: onChange, oninput: onChange }, fields(field("time", domain, { pointer: "/structure/timeDomain" })), place);
  return { element, value, coefficients: () => coefficientNames(value()) };
}

// "J [kg m2], k = 0.5" as coefficients, and back.
function coefficientsIn(text) {
  return text.split(",").map((part) => {
    const [, name, unit = "", known] = part.trim().match(/^([^[=]*?)\s*(?:\[([^\]]*)\])?\s*(?:=\s*(.*))?$/) ?? [null, part.trim()];
    return { name, unit, ...(known === undefined ? {} : { fixedAt: Number(known) }) };
  });
}

function coefficientText({ name, unit, fixedAt }) {
  return name + (unit ? ` [${unit}]` : "") + (fixedAt == null ? "" : ` = ${fixedAt}`);
}

// The names of the coefficients in their order.
export function coefficientNames({ na, nb, nc = 0, nd = 0, delay, denominator, numerator }) {
  if (denominator) return [...[...denominator, ...numerator].filter((one) => one.fixedAt == null).map((one) => one.name), ...(delay ? ["tau"] : [])];
  const numbered = (letter, first, last) => Array.from({ length: Math.max(last - first + 1, 0) }, (_, i) => `${letter}${first + i}`);
  return [...numbered("a", 1, na), ...numbered("b", 0, nb), ...(delay ? ["tau"] : []), ...numbered("c", 1, nc), ...numbered("d", 1, nd)];
}

// A structure in a few words.
export function structureText(structure) {
  const { timeDomain, na, nb, nk, nc, nd, order } = structure;
  if (timeDomain.endsWith("StateSpace")) return `state space, ${order ? `${order} states` : "order to be chosen"}, ${timeDomain.replace("StateSpace", "")} time`;
  if (timeDomain === "continuousPhysical") return `continuous time, output: ${structure.denominator.map(coefficientText).join(", ")}; input: ${structure.numerator.map(coefficientText).join(", ")}`;
  const noise = nc || nd ? `, noise of orders ${nc} and ${nd}` : "";
  const delay = (nk ? `, ${nk} samples of delay` : "") + (structure.delay ? ", delay estimated" : "");
  return `${timeDomain} time, ${na} ${na === 1 ? "pole" : "poles"}, numerator of order ${nb}${delay}${noise}`;
}
