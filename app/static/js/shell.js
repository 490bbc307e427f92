// What every page has: the theme, and the name of the plant.

import { get } from "./api.js";
import { context } from "./context.js";
import { byId } from "./dom.js";
import { installToggle } from "./theme.js";

installToggle(byId("theme"));
export const plant = context.plantId ? get(`/plants/${context.plantId}`) : null;
plant?.then((found) => {
  byId("plant-name").textContent = found.name;
  document.title = `${byId("title").textContent} · ${found.name} · lpv-oed`;
}, () => {});
