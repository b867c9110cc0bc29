// What all explorables share: axes, shapes, sliders, points to drag. Node reads this file, too.
//
// An explorable is { start, controls, measure, draw, say }, none of which touches the page:
//   start(settings)              the first state, a flat object
//   controls(settings)           sliders, switches, choices and buttons
//   measure(settings, state)     the numbers; tests ask for them
//   draw(settings, state, numbers, width)   { height, shapes, handles }: SVG as text, and points to drag
//   say(settings, state, numbers)           what the picture shows, in words
"use strict";

const explorables = {};

const draw = (() => {
  const attributes = (given) =>
    Object.entries(given)
      .filter(([, value]) => value !== undefined)
      .map(([name, value]) => ` ${name}="${typeof value === "number" ? tidy(value) : value}"`)
      .join("");
  // A tenth of a pixel: the same text on every machine.
  const tidy = (value) => String(Math.round(10 * value) / 10 + 0);
  const shape = (tag, given, inside = "") => `<${tag}${attributes(given)}>${inside}</${tag}>`;
  const line = (from, to, kind) =>
    shape("line", { x1: from[0], y1: from[1], x2: to[0], y2: to[1], class: kind });
  const path = (points, kind, closed = false) => {
    let pen = "M";
    const steps = points.map((p) => {
      if (!p.every(Number.isFinite)) return ((pen = "M"), "");
      const step = pen + p.map(tidy).join(" ");
      pen = "L";
      return step;
    });
    return shape("path", { d: steps.join("") + (closed ? "Z" : ""), class: kind });
  };
  const dot = (at, radius, kind) => shape("circle", { cx: at[0], cy: at[1], r: radius, class: kind });
  const box = (x, y, width, height, kind) =>
    shape("rect", { x, y, width: Math.max(width, 0), height: Math.max(height, 0), class: kind });
  const text = (at, words, anchor = "start", kind = undefined) =>
    shape("text", { x: at[0], y: at[1], "text-anchor": anchor, class: kind }, escape(words));
  const escape = (words) => String(words).replace(/&/g, "&amp;").replace(/</g, "&lt;");
  const arrow = (from, to, kind) => {
    const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
    if (length < 3) return "";
    const angle = Math.atan2(to[1] - from[1], to[0] - from[0]);
    const head = [0, 2.6, -2.6].map((turn) => [
      to[0] + (turn ? 11 : 0) * Math.cos(angle + turn),
      to[1] + (turn ? 11 : 0) * Math.sin(angle + turn),
    ]);
    return line(from, to, `${kind} thick`) + path(head, `${kind} filled`, true);
  };

  // A panel of axes: `at.x` and `at.y` turn quantities into pixels, `frame` draws the axes.
  function panel(place, x, y) {
    const scale = (axis, start, size) => {
      const f = axis.log ? Math.log : Number;
      const low = f(axis.from), high = f(axis.to);
      return (value) => start + (size * (f(value) - low)) / (high - low);
    };
    const across = scale(x, place.x, place.width);
    const up = scale(y, place.y + place.height, -place.height);
    const inside = (value, axis) => Math.min(Math.max(value, axis.from), axis.to);
    const bottom = place.y + place.height;
    return {
      left: place.x, top: place.y, right: place.x + place.width, bottom,
      x: across,
      y: up,
      to: (a, b) => [across(inside(a, x)), up(inside(b, y))],
      frame() {
        let shapes = "";
        for (const tick of x.ticks ?? []) {
          shapes += line([across(tick), bottom], [across(tick), bottom + 4], "axis");
          if (x.names !== false) shapes += text([across(tick), bottom + 18], number(tick), "middle");
        }
        for (const tick of y.ticks ?? []) {
          shapes += line([place.x, up(tick)], [place.x + place.width, up(tick)], "grid");
          shapes += text([place.x - 6, up(tick) + 4.5], number(tick), "end");
        }
        shapes += line([place.x, bottom], [place.x + place.width, bottom], "axis");
        if (x.label) {
          shapes += text([place.x + place.width / 2, bottom + 36], x.label, "middle");
        }
        return shapes + (y.label ? text([place.x, place.y - 9], y.label) : "");
      },
    };
  }
  const number = (value, digits = undefined) =>
    (digits === undefined ? String(+value.toPrecision(12)) : value.toFixed(digits)).replace("-", "−");
  // Few digits, and a power of ten where there are many zeros.
  const brief = (value) => {
    if (!Number.isFinite(value)) return "∞";
    const size = Math.abs(value);
    if (size !== 0 && (size < 1e-3 || size >= 1e5)) {
      const [front, back] = value.toExponential(0).split("e");
      const raised = [...back.replace("+", "")].map((c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻").join("");
      return `${front.replace("-", "−")}·10${raised}`;
    }
    return number(Number(value.toPrecision(2)));
  };
  return { arrow, box, brief, dot, line, number, panel, path, shape, text };
})();

// Numbers that several explorables need.
const algebra = {
  // Inverse of a symmetric, positive definite matrix, scaled to a unit diagonal; null if singular.
  inverse(matrix) {
    const n = matrix.length;
    const size = matrix.map((row, i) => Math.sqrt(row[i]));
    const factor = algebra.cholesky(matrix.map((row, i) => row.map((v, j) => v / size[i] / size[j])));
    if (!factor) return null;
    const columns = size.map((_, k) => {
      const unit = size.map((_, i) => (i === k ? 1 : 0));
      return algebra.backward(factor, algebra.forward(factor, unit));
    });
    return columns.map((column, j) => column.map((v, i) => v / size[i] / size[j]));
  },
  // Lower factor L of L L' = matrix, or null where rounding leaves nothing of a row.
  cholesky(matrix) {
    const L = matrix.map((row) => row.map(() => 0));
    for (let j = 0; j < L.length; j++) {
      for (let i = j; i < L.length; i++) {
        let rest = matrix[i][j];
        for (let k = 0; k < j; k++) rest -= L[i][k] * L[j][k];
        if (i === j) {
          if (!(rest > 1e-14 * matrix[j][j])) return null;
          L[j][j] = Math.sqrt(rest);
        } else L[i][j] = rest / L[j][j];
      }
    }
    return L;
  },
  forward(L, b) {
    const y = [];
    L.forEach((row, i) => y.push((b[i] - y.reduce((sum, v, k) => sum + row[k] * v, 0)) / row[i]));
    return y;
  },
  backward(L, y) {
    const x = y.map(() => 0);
    for (let i = x.length - 1; i >= 0; i--) {
      let rest = y[i];
      for (let k = i + 1; k < x.length; k++) rest -= L[k][i] * x[k];
      x[i] = rest / L[i][i];
    }
    return x;
  },
  // e' P^-1 e.
  distance(P, e) {
    const L = algebra.cholesky(P);
    return L ? algebra.forward(L, e).reduce((sum, v) => sum + v * v, 0) : NaN;
  },
  // Points of the ellipse of `deviations` around zero, of a 2 x 2 covariance.
  ellipse([[a, b], [, d]], deviations) {
    const half = Math.hypot((a - d) / 2, b), middle = (a + d) / 2;
    const turn = Math.atan2(2 * b, a - d) / 2;
    const [long, short] = [middle + half, middle - half].map((v) => deviations * Math.sqrt(Math.max(v, 0)));
    return Array.from({ length: 61 }, (_, i) => {
      const [c, s] = [Math.cos((i * Math.PI) / 30) * long, Math.sin((i * Math.PI) / 30) * short];
      return [c * Math.cos(turn) - s * Math.sin(turn), c * Math.sin(turn) + s * Math.cos(turn)];
    });
  },
  // Standard normal numbers from a seed: Mulberry32, then Box and Muller.
  normal(seed) {
    let state = seed >>> 0, kept = null;
    const uniform = () => {
      state = (state + 0x6d2b79f5) >>> 0;
      let t = Math.imul(state ^ (state >>> 15), state | 1);
      t = (t + Math.imul(t ^ (t >>> 7), t | 61)) ^ t;
      return (((t ^ (t >>> 14)) >>> 0) + 0.5) / 4294967296;
    };
    return () => {
      if (kept !== null) {
        const value = kept;
        kept = null;
        return value;
      }
      const radius = Math.sqrt(-2 * Math.log(uniform())), angle = 2 * Math.PI * uniform();
      kept = radius * Math.sin(angle);
      return radius * Math.cos(angle);
    };
  },
};

// The page: one picture that follows its state.
function mountExplorable(root, { start, controls, measure, draw: picture, say }) {
  const settings = JSON.parse(root.querySelector("script").textContent);
  const state = start(settings);
  const name = root.dataset.explorable;
  const SVG = "http://www.w3.org/2000/svg";
  const svg = root.querySelector("svg");
  const made = (tag, given = {}, space = undefined) => {
    const node = space ? document.createElementNS(space, tag) : document.createElement(tag);
    for (const [key, value] of Object.entries(given)) node.setAttribute(key, value);
    return node;
  };
  const shapes = made("g", { "aria-hidden": "true" }, SVG), grips = made("g", {}, SVG);
  svg.replaceChildren(shapes, grips);
  svg.setAttribute("role", "group");
  const panel = made("div", { class: "controls" }), says = made("p", { class: "says" });
  const spoken = made("output", { class: "visually-hidden" });
  svg.after(panel, says, spoken);

  const again = { kind: "button", name: "again", label: "start again", press: () => start(settings) };
  const buttons = made("div", { class: "control buttons" }); // side by side, also on a phone
  const shown = [...controls(settings), again].map((control) => {
    const id = `${name}-${control.name}`;
    const set = control.set ?? ((value) => ({ [control.name]: value }));
    const row = made("div", { class: `control ${control.kind === "play" ? "range play" : control.kind ?? "range"}` });
    const label = made("label", { for: id });
    label.textContent = control.label;
    let input, value;
    if (control.kind === "button") {
      input = made("button", { id, type: "button" });
      input.textContent = control.label;
      input.addEventListener("click", () => change(control.press(state)));
      buttons.append(input);
    } else if (control.kind === "choice") {
      input = made("select", { id });
      for (const [key, words] of control.options) {
        const option = made("option", { value: key });
        option.textContent = words;
        input.append(option);
      }
      input.addEventListener("input", () => change(set(input.value, state)));
      row.append(label, input);
    } else if (control.kind === "switch") {
      input = made("input", { id, type: "checkbox" });
      input.addEventListener("input", () => change(set(input.checked, state)));
      row.append(input, label);
    } else {
      const { min, max, step } = control;
      input = made("input", { id, type: "range", min, max, step });
      value = made("span", { class: "value", "aria-hidden": "true" });
      input.addEventListener("input", () => change(set(Number(input.value), state)));
      row.append(label, input, value);
      if (control.kind === "play") row.prepend(playing(control));
    }
    if (row.hasChildNodes()) panel.append(row);
    return { control, input, value };
  });
  panel.append(buttons);

  // Lets a slider run to its end, from the start again if it is there; a second press stops it.
  function playing({ name: key, label, min, max, step }) {
    const button = made("button", { type: "button", "aria-label": `Play ${label}` });
    let on = false;
    const mark = () => {
      button.textContent = on ? "❚❚" : "▶";
      button.setAttribute("aria-pressed", on);
    };
    const next = () => {
      if (!on || state[key] >= max) {
        on = false;
        return mark();
      }
      change({ [key]: state[key] + step });
      requestAnimationFrame(next);
    };
    button.addEventListener("click", () => {
      on = !on;
      mark();
      if (on && state[key] >= max) change({ [key]: min });
      next();
    });
    mark();
    return button;
  }

  const held = new Map();
  function grip({ name: key, label, target }) {
    const node = made("g", { class: "grip", role: "slider", tabindex: 0, "aria-label": label, "data-grip": key }, SVG);
    node.append(made("circle", { r: 22, class: "reach" }, SVG), made("circle", { r: 13, class: "ring" }, SVG));
    let off = null;
    const at = (event) => {
      const box = svg.getBoundingClientRect(), zoom = svg.viewBox.baseVal.width / box.width;
      return [(event.clientX - box.left) * zoom, (event.clientY - box.top) * zoom];
    };
    node.addEventListener("pointerdown", (event) => {
      node.setPointerCapture(event.pointerId);
      const [x, y] = at(event), now = held.get(key).at;
      off = [now[0] - x, now[1] - y];
      node.focus({ preventScroll: true });
      event.preventDefault();
    });
    // Of a group of shapes a browser does not heed touch-action: the page would scroll.
    node.addEventListener("touchstart", (event) => event.preventDefault(), { passive: false });
    node.addEventListener("pointermove", (event) => {
      if (!off || !node.hasPointerCapture(event.pointerId)) return;
      const [x, y] = at(event);
      change(held.get(key).move(x + off[0], y + off[1]));
    });
    node.addEventListener("lostpointercapture", () => (off = null));
    node.addEventListener("keydown", (event) => {
      const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
      const step = steps[event.key];
      if (!step) return;
      event.preventDefault();
      const far = event.shiftKey ? 20 : 4, now = held.get(key).at;
      change(held.get(key).move(now[0] + far * step[0], now[1] + far * step[1]));
    });
    grips.append(node);
    return node;
  }

  let waiting = false, silent;
  function change(part) {
    Object.assign(state, part);
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      show();
    });
  }
  function show() {
    const width = Math.min(Math.max(Math.round(root.clientWidth), 288), 760);
    const numbers = measure(settings, state);
    const drawn = picture(settings, state, numbers, width);
    svg.setAttribute("viewBox", `0 0 ${width} ${drawn.height}`);
    svg.style.maxWidth = `${width}px`;
    shapes.innerHTML = drawn.shapes;
    for (const handle of drawn.handles ?? []) {
      const old = held.get(handle.name);
      const node = old?.node ?? grip(handle);
      held.set(handle.name, { ...handle, node });
      node.setAttribute("transform", `translate(${handle.at.join(" ")})`);
      node.setAttribute("aria-valuenow", handle.now);
      node.setAttribute("aria-valuetext", handle.text);
    }
    for (const { control, input, value } of shown) {
      if (control.kind === "switch") input.checked = state[control.name];
      else if (control.kind === "choice") input.value = state[control.name];
      else if (control.kind !== "button") {
        input.value = state[control.name];
        value.textContent = control.text(state[control.name], numbers);
        input.setAttribute("aria-valuetext", value.textContent);
      }
    }
    says.textContent = say(settings, state, numbers);
    svg.setAttribute("aria-label", says.textContent);
    // Read aloud when the reader pauses, not at every step of a drag.
    clearTimeout(silent);
    silent = setTimeout(() => (spoken.textContent = says.textContent), 700);
    root.dataset.numbers = JSON.stringify(numbers);
  }
  new ResizeObserver(show).observe(root);
  show();
}

// An explorable wakes up when it comes near the window: until then its still picture stands there.
if (typeof document !== "undefined") {
  addEventListener("DOMContentLoaded", () => {
    const near = new IntersectionObserver(
      (entries) => {
        for (const { isIntersecting, target } of entries) {
          if (!isIntersecting) continue;
          near.unobserve(target);
          mountExplorable(target, explorables[target.dataset.explorable]);
        }
      },
      { rootMargin: "100% 0px" },
    );
    document.querySelectorAll("[data-explorable]").forEach((root) => near.observe(root));
  });
}
