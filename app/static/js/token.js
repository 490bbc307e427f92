// The token of a server that asks for one; kept for this tab only.

import { h } from "./dom.js";

const KEY = "lpv-oed-token";
let asking = null;

// The header that carries the token, if there is one.
export function authorization() {
  const token = sessionStorage.getItem(KEY);
  return token ? { Authorization: `Bearer ${token}` } : {};
}

// Ask for the token, once for all requests that wait for it; resolves when one was given.
export function askForToken() {
  asking ??= asked().finally(() => { asking = null; });
  return asking;
}

function asked() {
  return new Promise((resolve) => {
    const input = h("input", { type: "password", id: "token-input", autocomplete: "current-password", required: true });
    const refused = sessionStorage.getItem(KEY) ? h("p", { class: "field-problem" }, "The server does not know this token.") : null;
    const form = h("form", { method: "dialog" },
      h("h2", { id: "token-title" }, "This server asks for its token"),
      h("div", { class: "field" }, h("label", { for: "token-input" }, "Token"), input, refused),
      h("p", { class: "hint" }, "It is the one that the server was started with, and is kept until this tab is closed."),
      h("p", { class: "actions" }, h("button", {}, "Go on")));
    const dialog = h("dialog", { "aria-labelledby": "token-title", oncancel: (event) => event.preventDefault() }, form);
    dialog.addEventListener("close", () => {
      sessionStorage.setItem(KEY, input.value.trim());
      dialog.remove();
      resolve();
    });
    document.body.append(dialog);
    dialog.showModal();
  });
}
