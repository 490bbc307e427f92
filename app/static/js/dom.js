// Elements without markup in strings: whatever comes from data becomes text, never markup.

// An element. Attributes: "class", "data-…", "aria-…" and so on as they are called in HTML; `on…` functions are
// listeners; true and false set and leave out; null leaves out. Children: nodes, text, arrays of them, null.
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name.slice(2), value);
    else if (name === "value") element.value = value ?? "";
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value != null) element.setAttribute(name, value);
  }
  append(element, children);
  return element;
}

export function append(element, children) {
  for (const child of [children].flat(Infinity)) {
    if (child != null && child !== false) element.append(child);
  }
}

// Put children in the place of all that an element holds.
export function replace(element, ...children) {
  element.replaceChildren();
  append(element, children);
  element.removeAttribute("aria-busy");
}

export function byId(id) {
  return document.getElementById(id);
}

let count = 0;

// An identifier that no other element of the page has.
export function newId(stem) {
  count += 1;
  return `${stem}-${count}`;
}

// Say something to readers of the screen that nothing else on the page says.
export function announce(text) {
  byId("live").textContent = text;
}

// A list of facts: [value, meaning] each.
export function facts(...pairs) {
  const entries = pairs.filter(Boolean).map(([value, meaning]) => h("div", {}, h("dt", {}, meaning), h("dd", {}, value)));
  return h("dl", { class: "facts" }, entries);
}

// A box that stands out; kinds: problem, warning, success, or "" for a plain one.
export function message(kind, ...children) {
  return h("div", { class: `message ${kind}`, role: kind === "problem" ? "alert" : null }, children.map((child) =>
    typeof child === "string" ? h("p", {}, child) : child));
}
