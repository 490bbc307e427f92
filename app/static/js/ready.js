// A page's own work, with what goes wrong shown in it; `data-ready` marks that all in the window is drawn.

import { byId, message } from "./dom.js";
import { windowDone } from "./near_window.js";
import { problemBox } from "./problems.js";

export async function page(work) {
  try {
    await work();
    await windowDone();
  } catch (error) {
    for (const busy of document.querySelectorAll("[aria-busy]")) busy.removeAttribute("aria-busy");
    byId("content").append(error.title ? problemBox(error) : message("problem", `This page has a fault: ${error.message}`));
    if (!error.title) throw error;
  } finally {
    document.body.dataset.ready = "";
  }
}
