// The sliders of the figures, and the values of the point nearest to the pointer.
"use strict";
(function () {
  for (const figure of document.querySelectorAll("figure.charts")) {
    const slider = figure.querySelector("input[type=range]");
    if (slider) {
      const stops = JSON.parse(slider.dataset.stops);
      const show = () => {
        const pressure = slider.value > 0 ? stops[slider.value - 1] : null;
        slider.nextElementSibling.textContent = pressure === null ? "all pressures" : `${pressure} kPa`;
        for (const mark of figure.querySelectorAll("[data-p]")) {
          mark.classList.toggle("off", pressure !== null && Number(mark.dataset.p) !== pressure);
        }
      };
      slider.addEventListener("input", show);
      show();
    }
    for (const chart of figure.querySelectorAll("svg.chart")) follow(chart);
  }

  function numbers(text) {
    return (text.match(/-?\d+(\.\d+)?/g) || []).map(Number);
  }

  function text(value) {
    return Number(value.toPrecision(4)).toString();
  }

  function follow(chart) {
    const pointer = chart.querySelector(".pointer");
    const [left, top, width, height] = numbers(chart.dataset.plot);
    const [x0, x1, y0, y1] = chart.dataset.range.split(" ").map(Number);
    const lines = [...chart.querySelectorAll("path[data-name]")].map((path) => ({
      path, points: numbers(path.getAttribute("d").replaceAll("h0", "")),
    }));
    chart.addEventListener("pointermove", (event) => {
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(chart.getScreenCTM().inverse());
      let best = null;
      for (const { path, points } of lines) {
        if (path.classList.contains("off")) continue;
        for (let n = 0; n + 1 < points.length; n += 2) {
          const distance = Math.hypot(points[n] - at.x, points[n + 1] - at.y);
          if (distance < 24 && (!best || distance < best.distance)) {
            best = { distance, x: points[n], y: points[n + 1], name: path.dataset.name };
          }
        }
      }
      if (!best) {
        pointer.replaceChildren();
        return;
      }
      const x = x0 + ((best.x - left) / width) * (x1 - x0);
      const y = y1 - ((best.y - top) / height) * (y1 - y0);
      const circle = element("circle", { cx: best.x, cy: best.y, r: 5 });
      const note = element("text", { x: left + width - 4, y: top + 16 });
      note.textContent = `${best.name}: ${text(x)}, ${text(y)}`;
      pointer.replaceChildren(circle, note);
    });
    chart.addEventListener("pointerleave", () => pointer.replaceChildren());
  }

  function element(name, attributes) {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    return made;
  }
})();
