// Colours that colour-blind readers can tell apart.

import { colour, isDark } from "./theme.js";

const DASHES = ["solid", "dash", "dot", "dashdot", "longdash", "longdashdot"];
const SYMBOLS = ["circle", "square", "diamond", "triangle-up", "cross", "x"];

// The i-th of a few things in one plot: colour, line style and symbol, so that colour is not the only difference.
export const seriesColour = (index) => colour(`--series-${(index % 6) + 1}`);
export const dash = (index) => DASHES[index % DASHES.length];
export const symbol = (index) => SYMBOLS[index % SYMBOLS.length];

export function faded(hexadecimal, opacity) {
  const [red, green, blue] = rgb(hexadecimal);
  return `rgba(${red},${green},${blue},${opacity})`;
}

// Blue to orange through the colour of the page: differs in lightness from the middle, in hue between the ends.
const DIVERGING = {
  light: ["#08306b", "#2f6fae", "#8fb8de", "#f4f4f4", "#f3b27a", "#cc5f0c", "#6e2a00"],
  dark: ["#b9dcff", "#5fa5e6", "#2a5f95", "#23282e", "#94501c", "#ea8a3b", "#ffd9b0"],
};
// Dark to bright (light to dark on a light page), even steps of lightness.
const SEQUENTIAL = {
  light: ["#f7fbff", "#cfe1f2", "#93c3df", "#4b97c9", "#1764ab", "#083471", "#021733"],
  dark: ["#161b22", "#123a5e", "#14608f", "#2b8bbd", "#6bb5d8", "#b4dcec", "#f4fbff"],
};

// A scale as 256 colours [r, g, b], from its lower to its upper end.
export function scale(kind) {
  const stops = (kind === "diverging" ? DIVERGING : SEQUENTIAL)[isDark() ? "dark" : "light"].map(rgb);
  return Array.from({ length: 256 }, (_, index) => {
    const place = (index / 255) * (stops.length - 1);
    const left = Math.min(Math.floor(place), stops.length - 2);
    return stops[left].map((value, channel) => Math.round(value + (place - left) * (stops[left + 1][channel] - value)));
  });
}

function rgb(hexadecimal) {
  return [1, 3, 5].map((start) => parseInt(hexadecimal.slice(start, start + 2), 16));
}
