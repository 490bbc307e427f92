// Light and dark: as the system says, until chosen here.

const KEY = "lpv-oed-theme";
const system = matchMedia("(prefers-color-scheme: dark)");
const watchers = new Set();

export function isDark() {
  const chosen = document.documentElement.dataset.theme;
  return chosen ? chosen === "dark" : system.matches;
}

// Calls `watcher` whenever the theme has changed.
export function onThemeChange(watcher) {
  watchers.add(watcher);
}

// The value of a colour variable of the style, such as "--ink".
export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

export function installToggle(button) {
  const label = () => {
    button.textContent = isDark() ? "Light" : "Dark";
    button.setAttribute("aria-label", `${button.textContent} theme`);
  };
  button.addEventListener("click", () => {
    const chosen = isDark() ? "light" : "dark";
    document.documentElement.dataset.theme = chosen;
    localStorage.setItem(KEY, chosen);
    changed();
  });
  system.addEventListener("change", changed);
  onThemeChange(label);
  label();
}

function changed() {
  for (const watcher of watchers) watcher();
}
