// Fields of forms: a label, an input that says which part of the request it is, a hint.

import { h, newId } from "./dom.js";

// A labelled input. pointer: JSON pointer of what it states; hint: what it means, with its unit.
export function field(label, input, { hint = "", pointer = null, wide = false } = {}) {
  input.id ||= newId("field");
  if (pointer) input.dataset.pointer = pointer;
  const note = hint ? h("p", { class: "hint", id: `${input.id}-hint` }, hint) : null;
  if (note) input.setAttribute("aria-details", note.id);
  const check = input.type === "checkbox";
  const parts = check ? h("div", { class: "check" }, input, h("label", { for: input.id }, label)) : [h("label", { for: input.id }, label), input];
  return h("div", { class: wide ? "field wide" : "field" }, parts, note);
}

export function numberInput(value = null, attributes = {}) {
  return h("input", { type: "number", step: "any", value: value ?? "", ...attributes });
}

export function integerInput(value = null, attributes = {}) {
  return h("input", { type: "number", step: 1, value: value ?? "", ...attributes });
}

export function textInput(value = "", attributes = {}) {
  return h("input", { type: "text", value, autocomplete: "off", ...attributes });
}

export function checkbox(checked = false, attributes = {}) {
  const box = h("input", { type: "checkbox", ...attributes });
  box.checked = checked;
  return box;
}

// choices: [[value, label], …]
export function select(choices, chosen = null, attributes = {}) {
  const element = h("select", attributes, choices.map(([value, label]) => h("option", { value }, label)));
  if (chosen != null) element.value = chosen;
  return element;
}

// The number in a field; null when it is empty.
export function numberOf(input) {
  return input.value.trim() === "" ? null : Number(input.value);
}

// The numbers in a text field, separated by spaces, commas or semicolons; a part that is no number stays as it is, so
// that the server says what is wrong with it.
export function numbersOf(input) {
  const parts = input.value.split(/[\s,;]+/).filter(Boolean);
  return parts.map((part) => (Number.isNaN(Number(part)) ? part : Number(part)));
}

// A group of fields.
export function group(legend, ...children) {
  return h("fieldset", {}, h("legend", {}, legend), children);
}

export function fields(...children) {
  return h("div", { class: "fields" }, children);
}

// A button of a form that cannot be pressed twice while `action` goes on.
export function submitButton(label, action, attributes = {}) {
  const button = h("button", { type: "button", ...attributes }, label);
  button.addEventListener("click", async () => {
    button.disabled = true;
    try {
      await action(button);
    } finally {
      button.disabled = false;
    }
  });
  return button;
}
