// What the server knew when it sent the page: the parameters of its path, and where plotly.js is.

export const context = JSON.parse(document.body.dataset.context);
