"use strict";
(() => {
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
  let shownTime = () => times.flat().reduce((last, t) => (last > t ? last : t), undefined);
  for (const chart of charts) {
    chart.addEventListener("pointermove", (event) => {
      const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(chart.getScreenCTM().inverse());
      const { t0, t1, x0, x1 } = chart.dataset;
      markTime(+t0 + ((point.x - x0) / (x1 - x0)) * (t1 - t0));
    });
    chart.addEventListener("pointerleave", () => markTime(shownTime()));
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
      if (button.dataset.save === "csv") save(new Blob([chartCsv(figure)], { type: "text/csv" }), label, "csv");
      else save(await chartPng(figure), label, "png");
    });
  }
  if (!pictures) {
    markTime(shownTime());
    return;
  }

  /* Pictures: one field in one window at one time. */
  const [viewer, stack, slider] = ["viewer", "stack", "slider"].map(element);
  const chosen = (name) => +document.querySelector(`input[name=${name}]:checked`).value;
  const view = { zoom: 1, x: 0, y: 0 };
  shownTime = () => pictures.times[slider.value];

  function show() {
    const frame = +slider.value;
    const t = pictures.times[frame];
    const [quantity, pane] = [pictures.quantities[chosen("quantity")], pictures.windows[chosen("window")]];
    const [source, extremes] = pane.pictures[chosen("quantity")][frame];
    viewer.style.backgroundColor = quantity.ground || "";
    element("field").src = source;
    element("outline").src = pane.outline[frame];
    element("mesh").src = pane.mesh[frame];
    element("mesh").hidden = !element("mesh-lines").checked;
    const time = short(t, 8);
    element("time").textContent = `${time} (picture ${frame + 1} of ${pictures.times.length})`;
    slider.setAttribute("aria-valuetext", `t = ${time}`);
    const values = extremes ? `from ${extremes[0]} to ${extremes[1]}` : "not seen here";
    element("field").alt = `${quantity.label} at t = ${time}, ${pane.label}: ${values}`;
    element("caption").textContent = `In this picture: ${quantity.label} ${values}. ${pane.note}`;
    markTime(t);
  }

  function showLegend() {
    const quantity = pictures.quantities[chosen("quantity")];
    element("legend-label").textContent = quantity.label;
    element("legend-colours").style.background = quantity.colours;
    element("legend-ticks").replaceChildren(
      ...quantity.ticks.map(([part, text]) => {
        const tick = document.createElement("span");
        tick.style.left = `${100 * part}%`;
        tick.textContent = text;
        return tick;
      })
    );
  }

  /* The picture keeps its shape; it is as wide as the page, or as high as most of the screen. */
  function showWindow() {
    const pane = pictures.windows[chosen("window")];
    viewer.style.aspectRatio = `${pane.width} / ${pane.height}`;
    viewer.style.maxWidth = `calc(72vh * ${pane.width / pane.height})`;
    Object.assign(view, { zoom: 1, x: 0, y: 0 });
    place();
  }

  /* A point at p of the window, in parts of its edges, is seen at zoom p - (x, y). */
  function place() {
    view.zoom = Math.max(1, Math.min(40, view.zoom));
    for (const axis of ["x", "y"]) view[axis] = Math.max(0, Math.min(view.zoom - 1, view[axis]));
    stack.style.transform = `translate(${-100 * view.x}%, ${-100 * view.y}%) scale(${view.zoom})`;
    stack.style.imageRendering = view.zoom > 6 ? "pixelated" : "auto";
  }
  function zoomBy(factor, px = 0.5, py = 0.5) {
    const before = view.zoom;
    view.zoom = Math.max(1, Math.min(40, before * factor));
    view.x = ((view.x + px) / before) * view.zoom - px;
    view.y = ((view.y + py) / before) * view.zoom - py;
    place();
  }
  const parts = (event) => {
    const box = viewer.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  };
  viewer.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey) return;
    event.preventDefault();
    zoomBy(Math.exp(-0.002 * event.deltaY), ...parts(event));
  }, { passive: false });
  viewer.addEventListener("dblclick", (event) => zoomBy(2, ...parts(event)));
  viewer.addEventListener("pointermove", (event) => {
    const box = viewer.getBoundingClientRect();
    if (event.buttons === 1 && event.target.tagName !== "BUTTON") {
      view.x -= event.movementX / box.width;
      view.y -= event.movementY / box.height;
      place();
    }
    const { lower, upper, shifts, in_space } = pictures.windows[chosen("window")];
    if (in_space) return;
    const shift = shifts ? shifts[slider.value] : [0, 0];
    const [px, py] = parts(event);
    const x = shift[0] + lower[0] + ((view.x + px) / view.zoom) * (upper[0] - lower[0]);
    const y = shift[1] + upper[1] - ((view.y + py) / view.zoom) * (upper[1] - lower[1]);
    element("position").textContent = minus(`x = ${x.toPrecision(4)}, y = ${y.toPrecision(4)}`);
  });
  viewer.addEventListener("pointerleave", () => (element("position").textContent = ""));
  const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  viewer.addEventListener("keydown", (event) => {
    if (event.key === "+" || event.key === "=") zoomBy(1.5);
    else if (event.key === "-") zoomBy(1 / 1.5);
    else if (event.key === "0") zoomBy(1e-9);
    else if (event.key in moves && view.zoom > 1) {
      view.x += 0.15 * moves[event.key][0];
      view.y += 0.15 * moves[event.key][1];
      place();
    } else return;
    event.preventDefault();
  });
  element("zoom-in").addEventListener("click", () => zoomBy(1.5));
  element("zoom-out").addEventListener("click", () => zoomBy(1 / 1.5));
  element("zoom-reset").addEventListener("click", () => zoomBy(1e-9));

  /* Time: the slider, or played. */
  let timer = null;
  function stop() {
    clearInterval(timer);
    timer = null;
    element("play").textContent = "\u25b6";
    element("play").setAttribute("aria-label", "Play");
  }
  element("play").addEventListener("click", () => {
    if (timer !== null) return stop();
    element("play").textContent = "\u23f8";
    element("play").setAttribute("aria-label", "Pause");
    timer = setInterval(() => {
      slider.value = (+slider.value + 1) % pictures.times.length;
      show();
    }, 150);
  });
  slider.addEventListener("input", () => {
    stop();
    show();
  });
  element("mesh-lines").addEventListener("change", show);

  /* A picture with its legend and time, as the page shows it. */
  const LEGEND = 84;
  async function paint(canvas, frame) {
    const [quantity, pane] = [pictures.quantities[chosen("quantity")], pictures.windows[chosen("window")]];
    const layers = [pane.pictures[chosen("quantity")][frame][0], pane.outline[frame]];
    if (element("mesh-lines").checked) layers.push(pane.mesh[frame]);
    const images = layers.map((source) => Object.assign(new Image(), { src: source }));
    await Promise.all(images.map((image) => image.decode()));
    const pen = canvas.getContext("2d");
    pen.fillStyle = style("--ground");
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.fillStyle = quantity.ground || style("--panel");
    pen.fillRect(0, 0, pane.width, pane.height);
    pen.save();
    pen.beginPath();
    pen.rect(0, 0, pane.width, pane.height);
    pen.clip();
    pen.translate(-view.x * pane.width, -view.y * pane.height);
    pen.scale(view.zoom, view.zoom);
    images.forEach((image) => pen.drawImage(image, 0, 0));
    pen.restore();
    const [left, width, top] = [pane.width / 4, pane.width / 2, pane.height + 30];
    const colours = pen.createLinearGradient(left, 0, left + width, 0);
    const stops = quantity.colours.match(/#[0-9a-f]{6}/g);
    stops.forEach((colour, i) => colours.addColorStop(i / (stops.length - 1), colour));
    pen.fillStyle = colours;
    pen.fillRect(left, top, width, 14);
    pen.fillStyle = style("--ink");
    pen.font = "16px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.fillText(`${quantity.label},  t = ${short(pictures.times[frame], 4)}`, left + width / 2, top - 9);
    quantity.ticks.forEach(([part, text]) => pen.fillText(text, left + part * width, top + 34));
  }
  function canvasOf() {
    const pane = pictures.windows[chosen("window")];
    return Object.assign(document.createElement("canvas"), { width: pane.width, height: pane.height + LEGEND });
  }
  element("save-picture").addEventListener("click", async () => {
    const canvas = canvasOf();
    await paint(canvas, +slider.value);
    canvas.toBlob((blob) => save(blob, pictures.quantities[chosen("quantity")].label, "png"), "image/png");
  });

  /* All pictures of the shown field, once, as a film. */
  const film = element("save-film");
  film.hidden = typeof MediaRecorder === "undefined" || pictures.times.length < 2;
  film.addEventListener("click", async () => {
    stop();
    film.disabled = true;
    const canvas = canvasOf();
    await paint(canvas, 0);
    const recorder = new MediaRecorder(canvas.captureStream(30), { videoBitsPerSecond: 12e6 });
    const parts = [];
    recorder.ondataavailable = (event) => parts.push(event.data);
    const stopped = new Promise((done) => (recorder.onstop = done));
    recorder.start();
    for (let frame = 0; frame < pictures.times.length; frame++) {
      await paint(canvas, frame);
      await new Promise((done) => setTimeout(done, 150));
    }
    recorder.stop();
    await stopped;
    save(new Blob(parts, { type: recorder.mimeType }), pictures.quantities[chosen("quantity")].label, "webm");
    film.disabled = false;
  });
  for (const input of document.querySelectorAll("input[name=quantity], input[name=window]")) {
    input.addEventListener("change", () => {
      if (input.name === "window") showWindow();
      showLegend();
      show();
    });
  }
  showWindow();
  showLegend();
  show();
})();
