"use strict";
(() => {
  const { history, pictures } = JSON.parse(document.getElementById("data").textContent);
  const element = (id) => document.getElementById(id);
  const minus = (text) => text.replace(/-/g, "\u2212");
  const short = (value, digits = 6) => {
    const rounded = +value.toPrecision(digits);
    const size = Math.abs(rounded);
    return minus(size === 0 || (size >= 1e-4 && size < 1e6) ? String(rounded) : rounded.toExponential().replace("+", ""));
  };

  /* Charts: a line at a time, and the values of the slab that ends then. */
  const charts = [...document.querySelectorAll(".chart > svg")];
  const rowOf = (t) => {
    let best = 0;
    history.t.forEach((value, row) => {
      if (Math.abs(value - t) < Math.abs(history.t[best] - t)) best = row;
    });
    return best;
  };
  function markTime(t) {
    if (!history.t || history.t.length === 0) return;
    const row = rowOf(t);
    for (const chart of charts) {
      const { t0, t1, x0, x1 } = chart.dataset;
      const x = +x0 + ((Math.max(t0, Math.min(t1, t)) - t0) / (t1 - t0)) * (x1 - x0);
      const line = chart.querySelector(".cursor");
      line.setAttribute("x1", x);
      line.setAttribute("x2", x);
    }
    for (const output of document.querySelectorAll("output[data-column]")) {
      const value = history[output.dataset.column][row];
      output.textContent = value === null ? "" : short(value);
    }
  }
  let shownTime = () => (history.t && history.t.length ? history.t[history.t.length - 1] : 0);
  for (const chart of charts) {
    chart.addEventListener("pointermove", (event) => {
      const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(chart.getScreenCTM().inverse());
      const { t0, t1, x0, x1 } = chart.dataset;
      markTime(+t0 + ((point.x - x0) / (x1 - x0)) * (t1 - t0));
    });
    chart.addEventListener("pointerleave", () => markTime(shownTime()));
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
    element("field").src = source;
    element("outline").src = pane.outline[frame];
    element("mesh").src = pane.mesh[frame];
    element("mesh").hidden = !element("mesh-lines").checked;
    const time = short(t, 8);
    element("time").textContent = `${time} (picture ${frame + 1} of ${pictures.times.length})`;
    slider.setAttribute("aria-valuetext", `t = ${time}`);
    const values = extremes ? `from ${extremes[0]} to ${extremes[1]}` : "not seen here";
    element("field").alt = `${quantity.label} at t = ${time}, ${pane.label}: ${values}`;
    element("caption").textContent = `In this picture: ${quantity.label} ${values}.`;
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
    const { lower, upper } = pictures.windows[chosen("window")];
    const [px, py] = parts(event);
    const x = lower[0] + ((view.x + px) / view.zoom) * (upper[0] - lower[0]);
    const y = upper[1] - ((view.y + py) / view.zoom) * (upper[1] - lower[1]);
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
