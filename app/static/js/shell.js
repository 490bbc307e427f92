// What every page has: the theme, the name of the plant, what was deleted, and how to rename and delete.

import { get } from "./api.js";
import { context } from "./context.js";
import { append, byId } from "./dom.js";
import { managePart } from "./manage/manage.js";
import { sayDeletion } from "./manage/undo.js";
import { installToggle } from "./theme.js";

installToggle(byId("theme"));
sayDeletion();
append(byId("manage"), [managePart()]);
export const plant = context.plantId ? get(`/plants/${context.plantId}`) : null;
plant?.then((found) => {
  byId("plant-name").textContent = found.name;
  document.title = `${byId("title").textContent} · ${found.name} · lpv-oed`;
}, () => {});
