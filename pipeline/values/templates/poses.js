// Bends the arm of a page under its sliders and under the hand: shapes between those that the page holds.
"use strict";
for (const figure of document.querySelectorAll(".hand")) {
  const arm = JSON.parse(figure.querySelector("script").textContent);
  const many = arm.pressures.length, last = arm.points_along - 1, width = arm.points_along * arm.axes + 2;
  const counts = new Int16Array(Uint8Array.from(atob(arm.shapes), (c) => c.charCodeAt(0)).buffer);
  const shapes = Float64Array.from(counts, (count, k) => (count === -32768 ? NaN : count * arm.units[k % width]));
  const nodes = arm.pressures.map((one) => one.nodes), flat = arm.axes === 2, length = arm.length_mm;
  const most = flat ? Math.max(...arm.scales_N) * Math.sinh(arm.sizes.at(-1)) : arm.forces_N.at(-1);
  const at = [...nodes.map((known) => known.at(-1)), ...Array(arm.axes).fill(0)]; // kPa, then N
  const inputs = [...figure.querySelectorAll("input")], told = figure.querySelector(".told");
  const free = (state) => state.map((value, k) => (k < many ? value : 0));

  // the nodes next to a value, with the weights of the polynomial through them
  function weights(known, value, count) {
    const taken = Math.min(count, known.length), next = known.filter((node) => node <= value).length;
    const first = Math.max(0, Math.min(next - taken / 2, known.length - taken));
    return Array.from({ length: taken }, (_, i) => Math.floor(first) + i).map((i, _, own) =>
      [i, own.reduce((w, j) => (j === i ? w : w * (value - known[j]) / (known[i] - known[j])), 1)]
    ).filter(([, weight]) => weight !== 0);
  }

  // rows of pressures next to a state, with their weights
  function rows(state, count) {
    return nodes.reduce((terms, known, k) => terms.flatMap(([index, w]) =>
      weights(known, state[k], count).map(([i, weight]) => [index * known.length + i, w * weight])), [[0, 1]]);
  }

  function sum(terms) {
    const all = new Array(width).fill(0);
    if (terms.length > 1 && terms.some(([index]) => shapes[(index + 1) * width - 1] > 2.99)) all[0] = NaN; // not solved
    for (const [index, w] of terms) for (let c = 0; c < width; c++) all[c] += w * shapes[index * width + c];
    return all;
  }

  // in a plane: shapes in four directions next to that of the force from the chord, at its size over the scale
  function inPlane(state, count) {
    const near = rows(state, 2), of = (values) => near.reduce((all, [index, w]) => all + w * values[index], 0);
    const [x, y] = state.slice(many), size = Math.asinh(Math.hypot(x, y) / of(arm.scales_N)), each = arm.sizes.length;
    if (!(size <= arm.sizes.at(-1))) return null;
    const angle = Math.atan2(y, x) - of(arm.chords);
    let even = angle; // angle = even + denser sin(even)
    for (let k = 0; k < 40; k++) even = angle - arm.denser * Math.sin(even);
    const way = even / (2 * Math.PI) * arm.around, first = Math.floor(way) - (count / 2 - 1);
    const few = Array.from({ length: count }, (_, k) => first + k), radial = weights(arm.sizes, size, 4);
    const next = weights(few, way, count).flatMap(([k, w]) => radial.map(([i, weight]) =>
      [((few[k] % arm.around) + arm.around) % arm.around * each + i, w * weight]));
    return sum(rows(state, count).flatMap(([index, w]) => next.map(([i, weight]) => [index * arm.around * each + i, w * weight])));
  }

  // in space: what forces along the axes do is added
  function inSpace(state, count) {
    if (state.slice(many).some((force) => Math.abs(force) > most)) return null;
    const each = arm.forces_N.length, near = rows(state, count);
    const along = [0, 1, 2].map((axis) => sum(near.flatMap(([index, w]) =>
      weights(arm.forces_N, state[many + axis], count).map(([i, weight]) => [(index * 3 + axis) * each + i, w * weight]))));
    const rest = sum(near.map(([index, w]) => [index * 3 * each + (each - 1) / 2, w]));
    return rest.map((value, c) => along.reduce((all, part) => all + part[c] - value, value));
  }

  // points, angle and part of the law used; null where there is no shape
  function shape(state) {
    const [found, straight] = [4, 2].map((count) => (flat ? inPlane : inSpace)(state, count));
    if (!straight || !straight.every(Number.isFinite)) return null;
    return found.every(Number.isFinite) ? [...found.slice(0, -1), straight[width - 1]] : straight;
  }
  const known = (found) => found !== null && found[width - 1] <= 1.0001;
  const point = (found, k) => Array.from({ length: arm.axes }, (_, axis) => found[k * arm.axes + axis]);

  // the force in a view under which the tip comes nearest to a place, within the law
  function pull(place, axes) {
    const away = (state, found) => Math.hypot(...axes.map((axis, k) => point(found, last)[axis] - place[k]))
      + 1e-3 * length * Math.hypot(...state.slice(many)) / most;
    let best = [...at], least = away(best, shape(best)), ends = false;
    for (let step = most / 4; step > most / 1000;) {
      let better = null;
      for (const [a, b] of [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [1, -1], [-1, 1], [-1, -1]]) {
        const state = [...best];
        state[many + axes[0]] += a * step;
        state[many + axes[1]] += b * step;
        const found = shape(state);
        if (!found || away(state, found) >= least) { ends ||= !found; continue; }
        if (!known(found)) { ends = true; continue; }
        [better, least] = [state, away(state, found)];
      }
      if (better) best = better; else step /= 2;
    }
    at.splice(0, at.length, ...best);
    draw(ends && least > 0.02 * length);
  }

  // a pressure; of a force that the law does not bear there, the part that it does
  function inflate() {
    const next = [...inputs.map((input) => Number(input.value)), ...at.slice(many)];
    const part = (p) => next.map((value, k) => (k < many ? value : p * value));
    let ends = !known(shape(next));
    if (ends && known(shape(free(next)))) {
      let [low, high] = [0, 1];
      for (let k = 0; k < 12; k++) [low, high] = known(shape(part((low + high) / 2))) ? [(low + high) / 2, high] : [low, (low + high) / 2];
      at.splice(0, at.length, ...part(low));
    } else if (!ends) at.splice(0, at.length, ...next);
    inputs.forEach((input, k) => { input.value = at[k]; });
    draw(ends);
  }

  const views = [...figure.querySelectorAll("svg")].map((svg) => ({ svg, axes: JSON.parse(svg.dataset.axes) }));
  const drawn = (view, name, points, closed) => view.svg.querySelector(name).setAttribute("d",
    points.length ? `M${points.map((one) => text(...view.place(...one))).join("L")}${closed ? "Z" : ""}` : "");
  const line = (of, axes) => Array.from({ length: last + 1 }, (_, k) => axes.map((axis) => point(of, k)[axis]));
  const text = (x, y) => `${x.toFixed(2)},${y.toFixed(2)}`;
  for (const view of views) {
    const { svg, axes } = view, all = [[0, 0]];
    for (let n = 0; n < shapes.length; n += width) {
      if (shapes[n + width - 1] <= 1) for (let k = 0; k <= last; k += 4) all.push(axes.map((axis) => shapes[n + k * arm.axes + axis]));
    }
    const side = arm.body ? Math.max(...arm.body.high_mm, ...arm.body.low_mm.map(Math.abs)) : 0.06 * length;
    const [low, high] = [Math.min, Math.max].map((end, k) => [0, 1].map((axis) => end(...all.map((one) => one[axis])) + (k ? 1 : -1) * (side + 0.03 * length)));
    view.place = (x, y) => [x - low[0], high[1] - y];
    view.back = (x, y) => [x + low[0], high[1] - y];
    svg.setAttribute("viewBox", `0 0 ${high[0] - low[0]} ${high[1] - low[1]}`);
    svg.style.setProperty("--unit", `${length / 100}px`);
    const fan = many > 1 ? [] : nodes[0].map((p) => line(shape([p, ...at.slice(many).fill(0)]), axes));
    svg.querySelector(".fan").setAttribute("d", fan.map((one) => `M${one.map((xy) => text(...view.place(...xy))).join("L")}`).join(""));
    const [left, base] = view.place(0, 0), tall = Math.max(side, 0.05 * length);
    svg.querySelector(".wall").setAttribute("d", axes[0] ? "" : `M${text(left, base - 1.3 * tall)}v${2.6 * tall}`
      + Array.from({ length: 7 }, (_, k) => `M${text(left, base + (0.4 * k - 1.1) * tall)}l${-0.3 * tall},${0.3 * tall}`).join(""));
    const bar = 10 ** Math.floor(Math.log10(length / 2)), [x0, y0] = view.place(...[low[0], low[1]]);
    svg.querySelector(".bar").setAttribute("d", `M${text(x0 + bar * 0.1, y0 - bar * 0.1)}h${bar}`);
    Object.assign(svg.querySelector("text"), { textContent: `${bar} mm` });
    svg.querySelector("text").setAttribute("x", x0 + bar * 1.2);
    svg.querySelector("text").setAttribute("y", y0 - bar * 0.05);
    svg.addEventListener("pointerdown", (event) => {
      const [x, y] = seen(event), [tx, ty] = view.place(...axes.map((axis) => point(shape(at), last)[axis]));
      if (Math.hypot(x - tx, y - ty) > (event.pointerType === "touch" ? 0.16 : 0.08) * length) return;
      event.preventDefault();
      svg.setPointerCapture(event.pointerId);
    });
    svg.addEventListener("pointermove", (event) => {
      if (svg.hasPointerCapture(event.pointerId)) pull(view.back(...seen(event)), axes);
    });
    const seen = (event) => {
      const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
      return [x, y];
    };
    svg.querySelector(".tip").addEventListener("keydown", (event) => {
      const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!way) return;
      event.preventDefault();
      const next = [...at];
      axes.forEach((axis, k) => { next[many + axis] += way[k] * most / 40; });
      const bears = known(shape(next));
      if (bears) at.splice(0, at.length, ...next);
      draw(!bears);
    });
  }
  while (many > 1 && at.slice(0, many).some(Boolean) && !known(shape(at))) at[at.slice(0, many).findLastIndex(Boolean)] = 0;
  inputs.forEach((input, k) => { input.value = at[k]; input.addEventListener("input", inflate); });
  figure.querySelector("button").addEventListener("click", () => { at.splice(0, at.length, ...free(at)); draw(false); });

  // points of a line beside the arm, to its left by so much at each part of its length
  function beside(curve, aside) {
    const slope = (k) => curve[Math.min(last, k + 1)].map((value, axis) => value - curve[Math.max(0, k - 1)][axis]);
    return aside.map(([part, by]) => {
      const k = Math.min(last - 1, Math.floor(part * last)), t = part * last - k;
      const [a, b] = [slope(k), slope(k + 1)], along = [0, 1].map((axis) => a[axis] + t * (b[axis] - a[axis]));
      const size = Math.hypot(...along), [x, y] = [0, 1].map((axis) => curve[k][axis] + t * (curve[k + 1][axis] - curve[k][axis]));
      return [x - by * along[1] / size, y + by * along[0] / size];
    });
  }

  function draw(ends) {
    const found = shape(at), rest = shape(free(at)), force = at.slice(many), tip = point(found, last);
    for (const view of views) {
      const curve = line(found, view.axes), body = arm.body, parts = Array.from({ length: last + 1 }, (_, k) => k / last);
      const outline = (s, up, down) => [...beside(curve, s.map((one, k) => [one, up[k]])),
        ...beside(curve, s.map((one, k) => [one, down[k]])).reverse()];
      if (body) drawn(view, ".body", outline(body.s_mm.map((s) => Math.min(1, s / length)), body.high_mm, body.low_mm), true);
      const error = parts.map((part) => (arm.error_mm || 0) * part);
      drawn(view, ".error", arm.error_mm ? outline(parts, error, error.map((one) => -one)) : [], true);
      drawn(view, ".curve", curve);
      drawn(view, ".rest", force.some(Boolean) ? line(rest, view.axes) : []);
      const end = view.axes.map((axis) => tip[axis]), by = view.axes.map((axis) => 0.35 * length * force[axis] / most);
      const head = end.map((value, k) => value + by[k]), size = Math.hypot(...by), wing = Math.min(0.03 * length, size);
      const [ux, uy] = by.map((value) => value / (size || 1));
      drawn(view, ".force", size > 1e-3 * length ? [end, head, [head[0] - wing * (ux - 0.5 * uy), head[1] - wing * (uy + 0.5 * ux)],
        head, [head[0] - wing * (ux + 0.5 * uy), head[1] - wing * (uy - 0.5 * ux)]] : []);
      const [cx, cy] = view.place(...end);
      for (const dot of view.svg.querySelectorAll(".tip circle")) { dot.setAttribute("cx", cx); dot.setAttribute("cy", cy); }
      view.svg.querySelector(".points").innerHTML = arm.points.map((one) => {
        const near = 1 - Math.min(1, Math.abs(one.pressure_kPa - at[0]) / (0.1 * nodes[0].at(-1)));
        const [x, y] = view.place(one.x, one.y), name = one.told.replace(/[&<]/g, "");
        return `<circle cx="${x}" cy="${y}" r="${0.012 * length}" opacity="${0.25 + 0.75 * near}"><title>${name}</title></circle>`;
      }).join("");
    }
    figure.querySelectorAll("output").forEach((output, k) => { output.textContent = `${Number(at[k].toFixed(1))} kPa`; });
    const size = Math.hypot(...force), places = length < 20 ? 2 : 1;
    const angle = arm.error_mm ? ` ± ${(2 * arm.error_mm / Math.hypot(...tip) * 180 / Math.PI).toFixed(1)}°` : "";
    const error = arm.error_mm ? ` ± ${arm.error_mm.toFixed(places)}` : "";
    told.innerHTML = `<b>bends by ${found[width - 2].toFixed(1)}°${angle}</b> <b>tip at (${tip.map((one) => one.toFixed(places)).join(", ")})${error} mm</b> `
      + `<b>${size ? `pulled by (${force.map((one) => one.toPrecision(2)).join(", ")}) N` : "no force: drag the tip"}</b>`;
    figure.querySelector(".ends").hidden = !ends;
    figure.querySelector("button").disabled = !size;
    figure.dataset.tip = JSON.stringify(tip);
    figure.dataset.state = JSON.stringify(at);
  }
  draw(false);
}
