const { name, history, pictures } = JSON.parse(document.getElementById("data").textContent);
const element = (id) => document.getElementById(id);
const minus = (text) => text.replace(/-/g, "\u2212");
const short = (value, digits = 6) => {
  const rounded = +value.toPrecision(digits);
  const size = Math.abs(rounded);
  return minus(size === 0 || (size >= 1e-4 && size < 1e6) ? String(rounded) : rounded.toExponential().replace("+", ""));
};

/* Charts: a line at a time, and the values of the slab that ends then; one history for each run. */
const charts = [...document.querySelectorAll(".chart > svg")];
const times = history.map((columns) => columns.t || []);
const rowOf = (t, times) => {
  let best = 0;
  times.forEach((value, row) => {
    if (Math.abs(value - t) < Math.abs(times[best] - t)) best = row;
  });
  return best;
};
function markTime(t) {
  if (t === undefined) return;
  const rows = times.map((times) => rowOf(t, times));
  for (const chart of charts) {
    const { t0, t1, x0, x1 } = chart.dataset;
    const x = +x0 + ((Math.max(t0, Math.min(t1, t)) - t0) / (t1 - t0)) * (x1 - x0);
    const line = chart.querySelector(".cursor");
    line.setAttribute("x1", x);
    line.setAttribute("x2", x);
  }
  for (const output of document.querySelectorAll("output[data-column]")) {
    const value = history[output.dataset.run][output.dataset.column][rows[output.dataset.run]] ?? null;
    output.textContent = value === null ? "" : short(value, 3);
    output.title = value === null ? "" : String(value);
  }
}
let pointed = false;
let shownTime = () => times.flat().reduce((last, t) => (last > t ? last : t), undefined);
for (const chart of charts) {
  chart.addEventListener("pointermove", (event) => {
    pointed = true;
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(chart.getScreenCTM().inverse());
    const { t0, t1, x0, x1 } = chart.dataset;
    markTime(+t0 + ((point.x - x0) / (x1 - x0)) * (t1 - t0));
  });
  chart.addEventListener("pointerleave", () => {
    pointed = false;
    markTime(shownTime());
  });
}

/* What is shown, as files. */
function save(blob, label, extension) {
  const link = document.createElement("a");
  link.download = `${name}_${label.replace(/[^\p{L}\p{N}]+/gu, "_")}.${extension}`;
  link.href = URL.createObjectURL(blob);
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);

/* The curves of a chart: for each run its times and columns. */
function chartCsv(figure) {
  const outputs = [...figure.querySelectorAll("output[data-column]")];
  const runs = [...new Set(outputs.map((output) => +output.dataset.run))];
  const columns = runs.flatMap((run) => {
    const of = outputs.filter((output) => +output.dataset.run === run);
    const prefix = history.length > 1 ? `${of[0].dataset.label} ` : "";
    const values = of.map((output) => [prefix + output.dataset.column, history[run][output.dataset.column]]);
    return [[`${prefix}t`, times[run]], ...values];
  });
  const rows = Math.max(...columns.map(([, values]) => values.length));
  const line = (row) => columns.map(([, values]) => values[row] ?? "").join(",");
  return [columns.map(([head]) => quoted(head)).join(","), ...Array.from({ length: rows }, (_, row) => line(row))].join("\n") + "\n";
}

/* A chart with the styles of the page, twice as large. */
async function chartPng(figure) {
  const svg = figure.querySelector("svg:not(.key)");
  const copy = svg.cloneNode(true);
  const [originals, copies] = [[svg, ...svg.querySelectorAll("*")], [copy, ...copy.querySelectorAll("*")]];
  originals.forEach((original, i) => {
    const seen = getComputedStyle(original);
    for (const key of ["stroke", "stroke-width", "stroke-dasharray", "fill", "opacity", "font-size", "font-family", "text-anchor"]) {
      copies[i].style.setProperty(key, seen.getPropertyValue(key));
    }
  });
  copy.querySelector(".cursor").remove();
  const { width, height } = svg.viewBox.baseVal;
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  copy.setAttribute("width", 2 * width);
  copy.setAttribute("height", 2 * height);
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(new XMLSerializer().serializeToString(copy))}`;
  await image.decode();
  const labels = [...figure.querySelectorAll("output[data-column]")];
  const canvas = Object.assign(document.createElement("canvas"), { width: 2 * width, height: 2 * height + 40 + 26 * labels.length });
  const pen = canvas.getContext("2d");
  pen.fillStyle = style("--ground");
  pen.fillRect(0, 0, canvas.width, canvas.height);
  pen.drawImage(image, 0, 36);
  pen.fillStyle = style("--ink");
  pen.font = "600 24px system-ui, sans-serif";
  pen.fillText(figure.querySelector("figcaption").firstChild.textContent, 12, 28);
  pen.font = "22px system-ui, sans-serif";
  labels.forEach((output, i) => {
    const y = 2 * height + 56 + 26 * i;
    pen.strokeStyle = getComputedStyle(output.parentElement.querySelector(".curve")).stroke;
    pen.lineWidth = 3;
    pen.beginPath();
    pen.moveTo(140, y - 8);
    pen.lineTo(184, y - 8);
    pen.stroke();
    pen.fillText(output.dataset.label, 196, y);
  });
  return new Promise((done) => canvas.toBlob(done, "image/png"));
}
for (const button of document.querySelectorAll("[data-save]")) {
  button.addEventListener("click", async () => {
    const figure = button.closest("figure");
    const label = figure.querySelector("figcaption").firstChild.textContent;
    const thinned = figure.querySelector(".thinned")?.dataset.rows ?? "";
    if (button.dataset.save === "csv") save(new Blob([chartCsv(figure)], { type: "text/csv" }), `${label} ${thinned}`.trim(), "csv");
    else save(await chartPng(figure), label, "png");
  });
}
