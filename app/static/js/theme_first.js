// Runs before the page is drawn, so that a chosen theme does not flash; the rest is in theme.js.
{
  const chosen = localStorage.getItem("lpv-oed-theme");
  if (chosen) document.documentElement.dataset.theme = chosen;
}
