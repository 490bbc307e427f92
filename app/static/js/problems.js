// Problems where the reader finds them: at the field that the JSON pointer names, the rest above the form.

import { h, message, newId } from "./dom.js";

// Show a problem in `place` (above everything else it holds), or at the fields of `form` that have
// data-pointer="/…"; a field also takes what is said of its inner parts. Returns the first field with a problem.
export function showProblem(problem, { place, form = null }) {
  clearProblems(form ?? place, place);
  const rest = [];
  let first = null;
  for (const error of problem.errors ?? []) {
    const field = form && fieldOf(form, error.pointer);
    if (field) markField(field, error.detail);
    else rest.push(error);
    first ??= field;
  }
  const marked = (problem.errors ?? []).length - rest.length;
  place.prepend(problemBox(problem, rest, marked));
  first?.closest("details")?.setAttribute("open", "");
  if (first) (first.matches("input, select, textarea") ? first : first.querySelector("input, select, textarea, button") ?? first).focus();
  return first;
}

// What the service says of values that were left out or are none, in words for who fills in a form.
const PLAINLY = [
  [/^String should have at least 1 character/, "please fill this in"],
  [/^Input should be a valid (number|integer).*/, "give a number"],
  [/^Field required/, "please fill this in"],
  [/^Input should be (a valid|an) (list|array).*/, "give numbers, separated by spaces"],
];

function plainly(detail) {
  return PLAINLY.find(([pattern]) => pattern.test(detail))?.[1] ?? detail;
}

// A box with what went wrong.
export function problemBox(problem, errors = problem.errors ?? [], marked = 0) {
  const lines = errors.map((error) => h("p", {}, error.pointer ? h("code", {}, error.pointer) : null, ` ${plainly(error.detail)}`));
  const many = marked === 1 ? "One field needs a change." : `${marked} fields need a change.`;
  const told = marked && !lines.length ? many : lines.length ? null : problem.detail ?? problem.message;
  const box = message("problem", h("p", {}, h("strong", {}, problem.title ?? "Something went wrong")), told, lines);
  box.dataset.problem = "";
  return box;
}

function clearProblems(...places) {
  for (const place of places.filter(Boolean)) {
    for (const box of place.querySelectorAll("[data-problem]")) box.remove();
    for (const field of place.querySelectorAll("[aria-invalid]")) {
      field.removeAttribute("aria-invalid");
      field.removeAttribute("aria-describedby");
    }
  }
}

function fieldOf(form, pointer) {
  for (let path = pointer; path; path = path.slice(0, path.lastIndexOf("/"))) {
    const field = form.querySelector(`[data-pointer="${CSS.escape(path)}"]`);
    if (field) return field;
  }
  return null;
}

function markField(field, detail) {
  const id = newId("problem");
  const note = h("p", { class: "field-problem", id, "data-problem": "" }, plainly(detail));
  const inputs = field.matches("input, select, textarea") ? [field] : [...field.querySelectorAll("input, select, textarea")].slice(0, 1);
  for (const input of inputs) {
    input.setAttribute("aria-invalid", "true");
    input.setAttribute("aria-describedby", id);
  }
  (field.matches("input, select, textarea") ? field.closest(".field") ?? field.parentElement : field).append(note);
}
