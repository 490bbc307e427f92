// A choice from the catalogue with the options of what is chosen: whatever the service offers can be chosen here.

import { h, replace } from "./dom.js";
import { checkbox, field, fields, integerInput, numberInput, numberOf, numbersOf, select, textInput } from "./forms.js";

// entries: of one family of the catalogue; values: options to begin with, by kind; none: label of "no choice at all".
// Returns {element, value()}; value() is the document of the choice, or null for none.
export function pluginField(label, entries, { pointer, kind = null, values = {}, none = null, onChange = () => {} } = {}) {
  const choices = entries.map((entry) => [entry.kind, words(entry.kind)]);
  const chooser = select(none == null ? choices : [["", none], ...choices], kind ?? (none == null ? entries[0].kind : ""));
  const hint = h("p", { class: "hint wide" });
  const place = h("div", {});
  let readers = [];
  const draw = () => {
    const entry = entries.find((one) => one.kind === chooser.value);
    hint.textContent = withoutSources(entry?.description ?? "");
    const options = (entry?.options ?? []).map((option) => optionField(option, pointer, values[entry.kind]?.[option.name]));
    readers = options.filter(Boolean);
    const [needed, others] = [true, false].map((required) => readers.filter((one) => one.required === required).map((one) => one.element));
    replace(place, needed.length ? h("div", { class: "fields" }, needed) : null,
      others.length ? h("details", {}, h("summary", {}, "Options"), h("div", { class: "fields" }, others)) : null);
  };
  const element = h("div", { class: "wide", oninput: onChange, onchange: onChange }, fields(field(label, chooser, { pointer })), hint, place);
  chooser.addEventListener("change", draw);
  draw();
  const value = () => (chooser.value ? { kind: chooser.value, ...Object.fromEntries(readers.flatMap((one) => one.read())) } : null);
  return { element, value };
}

// A field for one option; null for options that no simple field can hold, which then keep their default.
function optionField({ name, description, required, valueSchema }, pointer, given) {
  const schema = simple(valueSchema);
  const start = given ?? valueSchema.default ?? null;
  const made = inputFor(schema, start);
  if (!made) return null;
  const [input, read] = made;
  const element = field(words(name), input, { hint: withoutSources(description), pointer: `${pointer}/${name}` });
  return { element, required, read: () => (read() == null && !required ? [] : [[name, read()]]) };
}

function inputFor(schema, start) {
  if (schema.enum) return withReader(select(schema.enum.map((one) => [one, words(one)]), start), (input) => input.value);
  if (schema.type === "boolean") return withReader(checkbox(start ?? false), (input) => input.checked);
  if (schema.type === "integer") return withReader(integerInput(start), numberOf);
  if (schema.type === "number") return withReader(numberInput(start), numberOf);
  if (schema.type === "string") return withReader(textInput(start ?? ""), (input) => input.value.trim() || null);
  if (schema.type === "array" && ["number", "integer"].includes(schema.items?.type)) {
    return withReader(textInput((start ?? []).join(" "), { placeholder: "numbers, separated by spaces" }), numbersOf);
  }
  return null;
}

const withReader = (input, read) => [input, () => read(input)];

// The schema of the values that are not null.
function simple(schema) {
  return schema.anyOf?.find((one) => one.type !== "null") ?? schema;
}

const withoutSources = (text) => text.replace(/ \[[A-Z]\w+\d{4}[a-z]?[^\]]*\]/g, "");

// Names of the interface in words.
export function words(name) {
  return name.replaceAll("_", " ").replace(/([a-z])([A-Z])/g, (_, before, after) => `${before} ${after.toLowerCase()}`);
}
