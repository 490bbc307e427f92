// What was deleted last in this window is said on the next page, with a button that brings it back.

import { post } from "../api.js";
import { byId, h, message } from "../dom.js";
import { submitButton } from "../forms.js";
import { showProblem } from "../problems.js";

const KEY = "deleted";

// Remember a deletion for the page that comes next: what it was and the page that it stood on.
export function rememberDeletion({ id, text, page }) {
  sessionStorage.setItem(KEY, JSON.stringify({ id, text, page }));
}

// Say what was deleted, once.
export function sayDeletion() {
  const kept = sessionStorage.getItem(KEY);
  if (!kept) return;
  sessionStorage.removeItem(KEY);
  const { id, text, page } = JSON.parse(kept);
  const place = h("div", {});
  const undo = async () => {
    try {
      await post(`/bin/${id}/restoration`, undefined);
      location.href = page;
    } catch (problem) {
      showProblem(problem, { place });
    }
  };
  place.append(message("success", h("p", {}, `${text} `, submitButton("Undo", undo, { class: "quiet" }), " It stays in the ", h("a", { href: "/bin" }, "bin"), ".")));
  byId("title").before(place);
}
