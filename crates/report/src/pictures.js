function showPictures() {
  /* Pictures: one field in one window at one time, or at the last time in one of the planes of a cut. */
  const [viewer, stack, slider, cut] = ["viewer", "stack", "slider", "cut"].map(element);
  const chosen = (name) => +document.querySelector(`input[name=${name}]:checked`).value;
  const pane = () => pictures.windows[chosen("window")];
  const view = { zoom: 1, x: 0, y: 0 };
  const frames = pictures.times.length;
  const pictureNumber = () => +(pane().cut ? cut : slider).value;
  shownTime = () => pictures.times[pane().cut ? frames - 1 : slider.value];

  function show() {
    const [quantity, window, number, t] = [pictures.quantities[chosen("quantity")], pane(), pictureNumber(), shownTime()];
    const [source, extremes] = window.pictures[chosen("quantity")][number];
    viewer.style.backgroundColor = quantity.ground || "";
    element("field").src = source;
    element("outline").src = window.outline[number];
    element("mesh").src = window.mesh[number];
    element("mesh").hidden = !element("mesh-lines").checked;
    const time = short(t, 8);
    element("time").textContent = `${time} (picture ${+slider.value + 1} of ${frames})`;
    slider.setAttribute("aria-valuetext", `t = ${time}`);
    const place = window.cut ? `${window.cut.axis} = ${short(window.cut.positions[number], 4)}` : "";
    element("cut-position").textContent = `${short(window.cut?.positions[number] ?? 0, 4)} at t = ${time}`;
    cut.setAttribute("aria-valuetext", place);
    const values = extremes ? `from ${extremes[0]} to ${extremes[1]}` : "not seen here";
    element("field").alt = `${quantity.label} at t = ${time}, ${window.label}${place && `, ${place}`}: ${values}`;
    element("caption").textContent = `In this picture: ${quantity.label} ${values}. ${window.note}`;
    if (!pointed) markTime(t);
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
    const window = pane();
    viewer.style.aspectRatio = `${window.width} / ${window.height}`;
    viewer.style.maxWidth = `calc(72vh * ${window.width / window.height})`;
    Object.assign(view, { zoom: 1, x: 0, y: 0 });
    place();
    element("mesh-lines").disabled = window.in_space;
    element("over-time").hidden = Boolean(window.cut);
    element("over-cut").hidden = !window.cut;
    film.hidden = noFilm || Boolean(window.cut);
    if (!window.cut) return;
    stop();
    element("cut-axis").textContent = window.cut.axis;
    cut.max = window.cut.positions.length - 1;
    cut.value = Math.floor(cut.max / 2);
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
  viewer.addEventListener("dblclick", (event) => {
    stop();
    zoomBy(2, ...parts(event));
  });
  viewer.addEventListener("pointermove", (event) => {
    const box = viewer.getBoundingClientRect();
    if (event.buttons === 1 && event.target.tagName !== "BUTTON") {
      dragged ||= Math.hypot(event.movementX, event.movementY) > 1;
      view.x -= event.movementX / box.width;
      view.y -= event.movementY / box.height;
      place();
    }
    const { lower, upper, shifts, in_space, axes } = pane();
    if (in_space) return;
    const shift = shifts ? shifts[slider.value] : [0, 0];
    const [px, py] = parts(event);
    const x = shift[0] + lower[0] + ((view.x + px) / view.zoom) * (upper[0] - lower[0]);
    const y = shift[1] + upper[1] - ((view.y + py) / view.zoom) * (upper[1] - lower[1]);
    element("position").textContent = minus(`${axes[0]} = ${x.toPrecision(4)}, ${axes[1]} = ${y.toPrecision(4)}`);
  });
  viewer.addEventListener("pointerleave", () => (element("position").textContent = ""));
  const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  viewer.addEventListener("keydown", (event) => {
    if (event.key === "+" || event.key === "=") zoomBy(1.5);
    else if (event.key === "-") zoomBy(1 / 1.5);
    else if (event.key === "0") zoomBy(1e-9);
    else if (event.key === " " && event.target === viewer) toggle();
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

  /* Time: the slider, or played in a loop that rests at its end. A click on the picture plays or pauses, unless the picture was dragged. */
  let timer = null;
  let dragged = false;
  function label(name) {
    element("play").classList.toggle("playing", name === "Pause");
    element("play").setAttribute("aria-label", name);
  }
  function stop() {
    clearTimeout(timer);
    timer = null;
    label("Play");
  }
  function next() {
    slider.value = (+slider.value + 1) % frames;
    show();
    timer = setTimeout(next, +slider.value === frames - 1 ? 1200 : 150);
  }
  function toggle() {
    if (timer !== null) return stop();
    if (pane().cut || frames < 2) return;
    label("Pause");
    timer = setTimeout(next, 150);
  }
  element("play").addEventListener("click", toggle);
  viewer.addEventListener("pointerdown", () => (dragged = false));
  viewer.addEventListener("click", (event) => {
    if (!dragged && event.detail === 1 && event.target.tagName !== "BUTTON") toggle();
  });
  slider.addEventListener("input", () => {
    stop();
    show();
  });
  cut.addEventListener("input", show);
  element("mesh-lines").addEventListener("change", show);

  /* A picture with its legend and time, as the page shows it; small pictures are enlarged, so that the legend has room. */
  const [LEGEND, LEAST_WIDTH] = [84, 640];
  const savedScale = () => Math.max(1, LEAST_WIDTH / pane().width);
  function paintField(pen, images, scale) {
    const [width, height] = [scale * pane().width, scale * pane().height];
    pen.save();
    pen.beginPath();
    pen.rect(0, 0, width, height);
    pen.clip();
    pen.translate(-view.x * width, -view.y * height);
    pen.scale(scale * view.zoom, scale * view.zoom);
    images.forEach((image) => pen.drawImage(image, 0, 0));
    pen.restore();
  }
  function paintLegend(pen, quantity, text, [left, width, top]) {
    const colours = pen.createLinearGradient(left, 0, left + width, 0);
    const stops = quantity.colours.match(/#[0-9a-f]{6}/g);
    stops.forEach((colour, i) => colours.addColorStop(i / (stops.length - 1), colour));
    pen.fillStyle = colours;
    pen.fillRect(left, top, width, 14);
    pen.fillStyle = style("--ink");
    pen.font = "16px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.fillText(text, left + width / 2, top - 9);
    quantity.ticks.forEach(([part, tick]) => pen.fillText(tick, left + part * width, top + 34));
  }
  async function paint(canvas, number) {
    const [quantity, window, scale] = [pictures.quantities[chosen("quantity")], pane(), savedScale()];
    const layers = [window.pictures[chosen("quantity")][number][0], window.outline[number]];
    if (element("mesh-lines").checked) layers.push(window.mesh[number]);
    const images = layers.map((source) => Object.assign(new Image(), { src: source }));
    await Promise.all(images.map((image) => image.decode()));
    const pen = canvas.getContext("2d");
    pen.fillStyle = style("--ground");
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.fillStyle = quantity.ground || style("--panel");
    pen.fillRect(0, 0, canvas.width, canvas.height - LEGEND);
    paintField(pen, images, scale);
    const place = window.cut ? `${window.cut.axis} = ${short(window.cut.positions[number], 4)},  ` : "";
    const t = window.cut ? shownTime() : pictures.times[number];
    const bar = [canvas.width / 4, canvas.width / 2, canvas.height - LEGEND + 30];
    paintLegend(pen, quantity, `${quantity.label},  ${place}t = ${short(t, 4)}`, bar);
  }
  function canvasOf() {
    const [width, height] = [pane().width, pane().height].map((pixels) => Math.round(savedScale() * pixels));
    return Object.assign(document.createElement("canvas"), { width, height: height + LEGEND });
  }
  element("save-picture").addEventListener("click", async () => {
    const canvas = canvasOf();
    await paint(canvas, pictureNumber());
    canvas.toBlob((blob) => save(blob, pictures.quantities[chosen("quantity")].label, "png"), "image/png");
  });

  /* All pictures of the shown field, once, as a film. */
  const film = element("save-film");
  const noFilm = typeof MediaRecorder === "undefined" || frames < 2;
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
    for (let frame = 0; frame < frames; frame++) {
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
  /* A run in time plays on opening, unless motion is not wanted. */
  if (frames > 2 && !matchMedia("(prefers-reduced-motion: reduce)").matches) toggle();
}
if (pictures) showPictures();
else markTime(shownTime());
