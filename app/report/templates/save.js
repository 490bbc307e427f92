// Every figure as SVG, PNG and CSV, every table as CSV; when the page is printed, the tables are open.
const slug = (text) => text.toLowerCase().replace(/[^\p{L}\p{N}]+/gu, "-").replace(/^-|-$/g, "").slice(0, 60) || "table";

function save(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// A cell as a spreadsheet reads it: 1.2·10⁻³ becomes 1.2e-3.
function plain(text) {
  const number = text.replaceAll("−", "-");
  const [, mantissa, power] = /^([-\d.]+)·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)$/.exec(number) ?? [];
  if (mantissa) return `${mantissa}e${[...power].map((sign) => "⁰¹²³⁴⁵⁶⁷⁸⁹".indexOf(sign)).join("").replace("-1", "-")}`;
  return /^-[\d.]+$/.test(number) ? number : text;
}

function csv(table) {
  const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  return "\ufeff" + [...table.rows].map((row) => [...row.cells].map((cell) => quoted(plain(cell.textContent))).join(",")).join("\r\n") + "\r\n";
}

function picture(svg) {
  const copy = svg.cloneNode(true);
  const { width, height } = svg.viewBox.baseVal;
  for (const [name, value] of Object.entries({ width, height, color: "#1b1f24" })) copy.setAttribute(name, value);
  const ground = document.createElementNS(svg.namespaceURI, "rect");
  for (const [name, value] of Object.entries({ width, height, fill: "#fff" })) ground.setAttribute(name, value);
  copy.prepend(ground);
  return { text: new XMLSerializer().serializeToString(copy), width, height };
}

async function png(svg) {
  const { text, width, height } = picture(svg);
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [2 * width, 2 * height];
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  return new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
}

function row(...buttons) {
  const place = document.createElement("p");
  place.className = "save";
  for (const [kind, name, make] of buttons) {
    const button = document.createElement("button");
    button.textContent = `Save ${kind}`;
    button.addEventListener("click", async () => save(await make(), `${name}.${kind.toLowerCase()}`));
    place.append(button);
  }
  return place;
}

const asCsv = (table) => new Blob([csv(table)], { type: "text/csv" });
for (const figure of document.querySelectorAll("figure")) {
  const [svg, table, caption] = ["svg", "table", "figcaption"].map((one) => figure.querySelector(one));
  const name = slug(caption.textContent);
  caption.after(row(
    ["SVG", name, () => new Blob([picture(svg).text], { type: "image/svg+xml" })], ["PNG", name, () => png(svg)], ["CSV", name, () => asCsv(table)]));
}
for (const place of document.querySelectorAll("section > .scroll")) {
  const table = place.querySelector("table");
  place.after(row(["CSV", slug(table.caption?.textContent ?? place.closest("section").querySelector("h2").textContent), () => asCsv(table)]));
}
addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((one) => { one.open = true; }));
