// Draws the panels of the figures of a page: unpacks plotly.js, follows size and colours of the page, and lets
// the buttons of a figure choose a frame and show or hide entries of the legend.
"use strict";
(async function () {
  const packed = Uint8Array.from(atob(document.getElementById("plotly-packed").textContent), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const script = document.createElement("script");
  script.textContent = await new Response(stream).text();
  document.head.append(script);

  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const touch = window.matchMedia("(pointer: coarse)").matches;
  const resized = new ResizeObserver((entries) => {
    for (const { target, contentRect } of entries) {
      if (contentRect.width === 0) continue; // within a closed section
      if (target.classList.contains("js-plotly-plot")) Plotly.Plots.resize(target);
      else draw(target.parentElement);
    }
  });
  const plots = [...document.querySelectorAll(".plot")];
  for (const plot of plots) resized.observe(plot.querySelector(".plot-area"));
  dark.addEventListener("change", () => plots.filter((plot) => plot.dataset.ready).forEach(draw));

  for (const figure of document.querySelectorAll(".plots")) {
    figure.addEventListener("click", (event) => {
      const button = event.target.closest("button");
      if (!button) return;
      if (button.dataset.frame === undefined) {
        button.setAttribute("aria-pressed", button.getAttribute("aria-pressed") !== "true");
      } else {
        for (const other of figure.querySelectorAll("button[data-frame]")) {
          other.setAttribute("aria-pressed", other === button);
        }
      }
      figure.querySelectorAll(".plot").forEach(show);
    });
  }

  function draw(plot) {
    const style = getComputedStyle(plot);
    const line = dark.matches ? "#343c45" : "#e4e8ec";
    const colours = { ink: style.color, grey: dark.matches ? "#a3adb8" : "#7b8794" };
    const { data, layout } = JSON.parse(plot.querySelector("script").textContent, (key, value) =>
      /color$/.test(key) && value in colours ? colours[value] : value);
    const axis = { gridcolor: line, linecolor: colours.grey, zeroline: false, automargin: true, ticks: "outside",
      tickcolor: line, hoverformat: ".4~g", exponentformat: "power" };
    const axes = layout.scene || layout;
    for (const name of ["xaxis", "yaxis", "zaxis"]) if (axes[name]) axes[name] = { ...axis, ...axes[name] };
    if (layout.scene) Object.assign(layout.scene, { dragmode: "turntable", camera: { eye: { x: 1.4, y: -1, z: 0.8 } } });
    Plotly.react(plot.querySelector(".plot-area"), data, {
      ...layout,
      font: { family: style.fontFamily, size: 12, color: style.color }, showlegend: false, hovermode: "closest",
      paper_bgcolor: "transparent", plot_bgcolor: "transparent", margin: { l: 52, r: 12, t: 12, b: 44 },
      dragmode: touch ? false : "zoom",
    }, { displaylogo: false, displayModeBar: touch ? false : "hover", modeBarButtonsToRemove: ["select2d", "lasso2d"] });
    plot.dataset.ready = "yes";
    show(plot);
  }

  function show(plot) {
    const area = plot.querySelector(".plot-area");
    if (!plot.dataset.ready) return;
    const figure = plot.closest(".plots");
    const pressed = (kind, state) => [...figure.querySelectorAll(`button[data-${kind}][aria-pressed=${state}]`)];
    const frame = pressed("frame", true).map((button) => button.dataset.frame).join("");
    const hidden = pressed("entry", false).map((button) => button.dataset.entry);
    const visible = area.data.map(({ meta }) =>
      !hidden.includes(meta.entry) && (!frame || !meta.frame || meta.frame === frame));
    if (area.data.length) Plotly.restyle(area, { visible });
  }
})();
