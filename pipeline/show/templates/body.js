// The deformed body in WebGL: turned by dragging, with sliders for the pressure and colours for a field.
"use strict";
// after the first paint, so that the text does not wait for the body
window.addEventListener("load", () => requestAnimationFrame(() => setTimeout(start)));

function start() {
  const figure = document.getElementById("body-view");
  const source = document.getElementById("body-data");
  if (!figure || !source) return;
  const data = JSON.parse(source.textContent);
  const canvas = figure.querySelector("canvas");
  const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
  if (!gl) {
    figure.classList.add("without");
    return;
  }
  const bytes = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0));
  const ramp = JSON.parse(figure.dataset.ramp);
  const size = data.high_mm.map((value, axis) => value - data.low_mm[axis]);
  const rest = new Uint16Array(bytes(data.rest).buffer);
  const raw = bytes(data.triangles).buffer;
  const triangles = data.wide ? new Uint32Array(raw) : new Uint16Array(raw);
  const nodes = rest.length / 3;

  const states = data.states.map((state) => {
    const positions = new Uint16Array(bytes(state.positions).buffer);
    const fields = Object.fromEntries(Object.keys(data.limits).map((name) => [name, bytes(state[name])]));
    return { ...state, positions, fields };
  });
  const limits = { ...data.limits, displacement: [0, addDisplacements()] };

  // the length of the displacement of every node, in parts of the largest one; returns that in mm
  function addDisplacements() {
    const lengths = states.map((state) => {
      const found = new Float32Array(nodes);
      for (let n = 0; n < nodes; n++) {
        let sum = 0;
        for (let axis = 0; axis < 3; axis++) {
          sum += (((state.positions[3 * n + axis] - rest[3 * n + axis]) / 65535) * size[axis]) ** 2;
        }
        found[n] = Math.sqrt(sum);
      }
      return found;
    });
    const largest = Math.max(1e-9, ...lengths.map((found) => found.reduce((a, b) => Math.max(a, b), 0)));
    lengths.forEach((found, k) => {
      states[k].fields.displacement = Uint8Array.from(found, (value) => Math.round((255 * value) / largest));
    });
    return largest;
  }

  function at(field, name) { // a field of the body at rest is uniform
    if (name) return name.fields[field];
    const [low, high] = limits[field];
    const value = field === "stretch" ? (255 * (1 - low)) / (high - low || 1) : 0;
    return new Uint8Array(nodes).fill(Math.min(255, Math.max(0, Math.round(value))));
  }

  const program = gl.createProgram();
  for (const [kind, id] of [[gl.VERTEX_SHADER, "body-vertex"], [gl.FRAGMENT_SHADER, "body-fragment"]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, document.getElementById(id).textContent.trim());
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  gl.useProgram(program);
  const place = (name) => gl.getUniformLocation(program, name);

  function attribute(name, width, type) {
    const buffer = gl.createBuffer();
    const location = gl.getAttribLocation(program, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, width, type, true, 0, 0);
    return buffer;
  }
  const positionBuffer = attribute("position", 3, gl.UNSIGNED_SHORT);
  const valueBuffer = attribute("value", 1, gl.UNSIGNED_BYTE);
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
  gl.uniform3fv(place("low"), data.low_mm);
  gl.uniform3fv(place("size"), size);
  gl.uniform3fv(place("ramp"), ramp.flat());
  gl.enable(gl.DEPTH_TEST);

  const start = { yaw: -0.35, pitch: 0.3, zoom: 1 };
  let view = { ...start };
  const control = (name) => figure.querySelector(`[name=${name}]`);
  const stops = (experiment) => states.filter((state) => state.experiment === experiment);
  const chosen = () => stops(control("experiment").value)[control("pressure").value - 1]; // none at rest

  function load() {
    const state = chosen();
    const field = control("field").value;
    gl.bindBuffer(gl.ARRAY_BUFFER, positionBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, state ? state.positions : rest, gl.DYNAMIC_DRAW);
    gl.bindBuffer(gl.ARRAY_BUFFER, valueBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, at(field, state), gl.DYNAMIC_DRAW);
    const digits = (value) => Number(value.toPrecision(3)).toString();
    figure.querySelector(".low").textContent = digits(limits[field][0]);
    figure.querySelector(".high").textContent = digits(limits[field][1]);
    figure.querySelector("output").textContent = state ? `${state.pressure_kPa} kPa` : "0 kPa, at rest";
    draw();
  }

  function rotation() {
    const [a, b, c, d] = [Math.cos(view.yaw), Math.sin(view.yaw), Math.cos(view.pitch), Math.sin(view.pitch)];
    return [a, b * d, -b * c, 0, c, d, b, -a * d, a * c]; // columns
  }

  // the middle and half the extent of what this experiment moves through, seen from the present direction
  function frame(turn, aspect) {
    const ends = [[Infinity, -Infinity], [Infinity, -Infinity]];
    const seen = (values, sign) => {
      for (let n = 0; n < nodes; n += 7) {
        const p = [0, 1, 2].map((axis) => data.low_mm[axis] + (values[3 * n + axis] / 65535) * size[axis]);
        p[2] *= sign;
        for (let k = 0; k < 2; k++) {
          const q = turn[k] * p[0] + turn[k + 3] * p[1] + turn[k + 6] * p[2];
          ends[k] = [Math.min(ends[k][0], q), Math.max(ends[k][1], q)];
        }
      }
    };
    for (const values of [rest, ...stops(control("experiment").value).map((state) => state.positions)]) {
      seen(values, 1);
      if (data.half) seen(values, -1);
    }
    const half = Math.max((ends[0][1] - ends[0][0]) / aspect, ends[1][1] - ends[1][0]) * 0.54;
    return { middle: ends.map(([low, high]) => (low + high) / 2), half: half / view.zoom };
  }

  function draw() {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (!width || !height) return;
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const turn = rotation();
    const { middle, half } = frame(turn, width / height);
    gl.uniformMatrix3fv(place("turn"), false, turn);
    gl.uniform2fv(place("middle"), middle);
    gl.uniform1f(place("depth"), 2 * Math.hypot(...size));
    gl.uniform2f(place("half_extent"), (half * width) / height, half);
    const open = control("open") && control("open").checked;
    const type = data.wide ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT;
    const signs = open ? [-1] : data.half ? [1, -1] : [1]; // cut open: the half beyond the plane of symmetry
    for (const sign of signs) {
      gl.uniform1f(place("mirror"), sign);
      gl.drawElements(gl.TRIANGLES, open ? triangles.length : 3 * data.outer, type, 0);
    }
  }

  function fitSlider() {
    const slider = control("pressure");
    slider.max = stops(control("experiment").value).length;
    slider.value = slider.max;
    load();
  }

  control("experiment").addEventListener("change", fitSlider);
  control("pressure").addEventListener("input", load);
  control("field").addEventListener("change", load);
  if (control("open")) {
    control("open").addEventListener("change", () => {
      view = { ...start }; // from here the plane of symmetry faces the reader
      draw();
    });
  }
  control("reset").addEventListener("click", () => { view = { ...start }; draw(); });
  control("closer").addEventListener("click", () => { view.zoom = Math.min(8, view.zoom * 1.25); draw(); });
  control("farther").addEventListener("click", () => { view.zoom = Math.max(0.5, view.zoom / 1.25); draw(); });

  function turnBy(yaw, pitch) {
    view.yaw += yaw;
    view.pitch = Math.max(-1.5, Math.min(1.5, view.pitch + pitch));
    draw();
  }
  let grasp = null;
  canvas.addEventListener("pointerdown", (event) => {
    grasp = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!grasp) return;
    turnBy((event.clientX - grasp[0]) * 0.01, (event.clientY - grasp[1]) * 0.01);
    grasp = [event.clientX, event.clientY];
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { grasp = null; });
  const arrows = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
  canvas.addEventListener("keydown", (event) => {
    if (!arrows[event.key]) return;
    event.preventDefault();
    turnBy(...arrows[event.key]);
  });
  new ResizeObserver(draw).observe(canvas);
  fitSlider();
  figure.dataset.ready = "";
}
