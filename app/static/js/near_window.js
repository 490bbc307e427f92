// Work on elements that waits until they come near the window; `data-waits` is set until it is done.

import { pause } from "./api.js";

const begins = new WeakMap(); // of each element: begins its work, once, and gives the promise of it
let line = Promise.resolve();

// Work begins one window ahead, one piece after the other, so that the page answers in between.
const observer = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) {
    if (!isIntersecting) continue;
    observer.unobserve(target);
    line = line.then(() => target.isConnected && begin(target)).catch(() => {}).then(() => pause(0));
  }
}, { rootMargin: "100% 0px" });

// Do `work` once an element comes near the window; resolves when it is done.
export function whenNear(element, work) {
  let begun = null;
  element.dataset.waits = "";
  observer.observe(element);
  return new Promise((resolve) => {
    begins.set(element, () => {
      begun ??= work().finally(() => delete element.dataset.waits);
      resolve(begun);
      return begun;
    });
  });
}

// Do the work of an element now, if it is not done; resolves when it is done.
export const begin = (element) => begins.get(element)();

// Resolves when the work of all elements in the window is done.
export function windowDone() {
  return Promise.all(waiting().filter(isInWindow).map(begin));
}

const waiting = () => [...document.querySelectorAll("[data-waits]")];

function isInWindow(element) {
  const { top, bottom, width } = element.getBoundingClientRect();
  return width > 0 && bottom > 0 && top < innerHeight;
}

addEventListener("beforeprint", () => waiting().forEach(begin));
