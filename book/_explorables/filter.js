// A tracker at work: its errors beside what it says of them, and the faults that NIS sees or not.
"use strict";

explorables.filter = (() => {
  const DIAL = { from: 0.1, to: 1e5, log: true };
  const times = (exponent) => `× ${draw.brief(10 ** exponent)}`;

  // A target that is pushed on each axis, and what the sensors measure of it `late` samples later.
  function simulate(settings, state, run) {
    const { start, spread, T, sigmaA, sigmaF, samples, sensors, perSpeed } = settings;
    const normal = algebra.normal(1000 * state.seed + run);
    const first = start.map((value) => value + spread * normal());
    const truth = [], push = Array.from({ length: samples }, () => [normal(), normal(), normal()]);
    let x = first;
    for (const a of push) {
      x = [0, 1, 2].map((i) => x[i] + T * x[i + 3] + ((T * T) / 2) * sigmaA * a[i])
        .concat([0, 1, 2].map((i) => x[i + 3] + T * sigmaA * a[i]));
      truth.push(x);
    }
    // Before the record it went straight.
    const seen = (k) => truth[k] ?? first.map((v, i) => (i < 3 ? v + (k + 1) * T * first[i + 3] : v));
    const z = truth.map((_, k) =>
      sensors.map((s) => {
        const [shift] = kernels.doppler_shift(...seen(k - state.late), ...s, perSpeed);
        return (state.sign ? -shift : shift) + sigmaF * normal();
      }));
    return { truth, z };
  }

  function track(settings, state, z) {
    const { start, spread, T, columns, sigmaA, sigmaF, sensors, perSpeed, gates } = settings;
    const variance = (sigmaF * 10 ** state.R) ** 2, sigma = sigmaA * 10 ** state.Q;
    const P = tracker.diagonal(Array(6).fill((spread * 10 ** state.P0) ** 2));
    return tracker.run({ x: start, P }, z, {
      sensors, perSpeed, T,
      noise: columns.map((column) => column.map((value) => sigma * value)),
      variance: () => variance,
      gate: gates[state.gate],
    });
  }

  const { mean } = tracker;

  // All runs of a setting; moving along time asks for nothing new.
  let last = null;
  function runs(settings, state) {
    const { k, ...knobs } = state, key = JSON.stringify(knobs);
    if (last?.key === key) return last;
    const records = Array.from({ length: settings.runs }, (_, run) => {
      const { truth, z } = simulate(settings, state, run);
      const found = track(settings, state, z);
      const error = found.x.map((x, i) => x.map((value, c) => value - truth[i][c]));
      return { truth, error, ...found };
    });
    const every = Array.from({ length: settings.samples / settings.every }, (_, i) => (i + 1) * settings.every - 1);
    return (last = { key, records, every, ...tracker.judged(records, every, settings.window, mean) });
  }

  return {
    simulate, track,
    start: ({ every }) => ({ R: 0, Q: 0, P0: 0, sign: false, late: 0, gate: "none", seed: 1, k: 60 * every - 1 }),
    controls: ({ samples, every, window, T }) => [
      { kind: "play", name: "k", label: "time", min: window - 1, max: samples - 1, step: every, text: (v) => `${draw.number((v + 1) * T, 2)} s` },
      { name: "late", label: "clock late", min: 0, max: 30, step: 1, text: (v) => `${v} ms` },
      { name: "P0", label: "P0 deviation", min: -1, max: 1.5, step: 0.1, text: times },
      { name: "R", label: "R deviation", min: -1, max: 1, step: 0.1, text: times },
      { name: "Q", label: "Q deviation", min: -1, max: 1, step: 0.1, text: times },
      { kind: "choice", name: "gate", label: "gate", options: [["none", "none"], ["upper", "upper, 95 %"], ["two-sided", "two-sided, 95 %"]] },
      { kind: "switch", name: "sign", label: "wrong sign" },
      { kind: "button", name: "noise", label: "new noise", press: (state) => ({ seed: state.seed + 1 }) },
    ],
    measure(settings, state) {
      const { records, every, nees, nis } = runs(settings, state);
      const at = every.indexOf(state.k);
      const finite = (value) => (Number.isFinite(value) ? value : null);
      const refused = mean(records.map(({ updated }) => mean(updated.slice(0, state.k + 1).map((v) => (v ? 0 : 1)))));
      const off = mean(records.map(({ error }) => Math.hypot(...error[state.k].slice(0, 3)) ** 2));
      const said = mean(records.map(({ P }) => [0, 1, 2].reduce((sum, i) => sum + P(state.k)[i][i], 0)));
      return {
        time: (state.k + 1) * settings.T, nis: finite(nis[at - every.length + nis.length]), nees: finite(nees[at]), refused,
        error: finite(Math.sqrt(off)), claimed: finite(Math.sqrt(said)),
      };
    },
    draw(settings, state, numbers, width) {
      const { records, every, nees, nis } = runs(settings, state);
      const wide = width >= 600, gap = 56;
      const third = wide ? Math.round((width - gap) / 3) : width;

      // The path of the first run, seen from above.
      const high = wide ? 190 : 170, scale = Math.min((third - 20) / 0.95, (high - 26) / 0.44);
      const place = ([x, y]) => [12 + (x + 0.02) * scale, 16 + high / 2 - y * scale];
      const inside = (p) => (p.every(Number.isFinite) && p[0] > -5 && p[0] < third && p[1] > 24 && p[1] < high + 6 ? p : [NaN, NaN]);
      const [run] = records, past = every.filter((i) => i <= state.k);
      let shapes = draw.text([0, 14], "one run, from above");
      settings.sensors.forEach((s, n) => (shapes += draw.dot(place(s), 4, `sensor-${n} filled`)));
      shapes += draw.path(run.truth.map(place).filter((_, i) => i % 10 === 0), "truth dashed");
      shapes += draw.path(past.map((i) => inside(place(run.x[i]))), "ours thick");
      const now = inside(place(run.x[state.k])), true_ = place(run.truth[state.k]);
      if (Number.isFinite(now[0])) shapes += draw.dot(now, 5, "ours filled");
      shapes += draw.box(true_[0] - 5, true_[1] - 5, 10, 10, "truth filled");
      const foot = [[third - 60 - 0.2 * scale, high - 4], [third - 60, high - 4]];
      shapes += draw.line(...foot, "axis") + draw.text([foot[1][0] + 6, high], "0.2 m");

      // Errors of all runs around the truth, and the ellipse that should hold 95 % of them.
      const left = wide ? third + 28 : 0, top = wide ? 0 : high + 28;
      const P = run.P(state.k), cloud = records.map(({ error }) => error[state.k]);
      const ring = algebra.ellipse([[P[0][0], P[0][1]], [P[1][0], P[1][1]]], Math.sqrt(settings.disc95));
      const most = Math.max(...ring.flat().map(Math.abs), ...cloud.flatMap(([x, y]) => [Math.abs(x), Math.abs(y)]));
      const tick = [1e-5, 2e-5, 5e-5, 1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2]
        .find((size) => size * 1.6 >= most) ?? 5;
      const half = (high - 24) / 2, middle = [left + third / 2, top + 24 + half];
      const around = ([x, y]) => [middle[0] + (x / tick / 1.7) * half, middle[1] - (y / tick / 1.7) * half]
        .map((v, i) => Math.min(Math.max(v, middle[i] - 1.2 * half), middle[i] + 1.2 * half));
      shapes += draw.text([left, top + 14], `errors of ${records.length} runs, and P`);
      shapes += draw.line([middle[0] - half, middle[1]], [middle[0] + half, middle[1]], "grid");
      shapes += draw.line([middle[0], middle[1] - half], [middle[0], middle[1] + half], "grid");
      if (ring.flat().every(Number.isFinite)) shapes += draw.path(ring.map(around), "ours region", true);
      cloud.filter((e) => e.every(Number.isFinite)).forEach((e) => (shapes += draw.dot(around(e), 3.5, "truth filled")));
      const mark = [[middle[0] + half - half / 1.7, middle[1] + half - 2], [middle[0] + half, middle[1] + half - 2]];
      shapes += draw.line(...mark, "axis");
      shapes += draw.text([mark[1][0] + 4, mark[1][1] + 4], tick < 0.01 ? `${draw.number(1000 * tick)} mm` : `${draw.number(100 * tick)} cm`);

      // Two needles.
      const size = wide ? 70 : Math.min(width / 4 - 10, 70);
      const dials = wide
        ? [[width - size - 14, 92], [width - size - 14, 196]]
        : [[size + 6, 2 * high + 128], [width - size - 6, 2 * high + 128]];
      const turn = (value) => Math.PI * (1 - Math.log(Math.min(Math.max(value, DIAL.from), DIAL.to) / DIAL.from) / Math.log(DIAL.to / DIAL.from));
      const arc = (center, from, to, radius, kind) =>
        draw.path(Array.from({ length: 31 }, (_, i) => {
          const a = turn(from * (to / from) ** (i / 30));
          return [center[0] + radius * Math.cos(a), center[1] - radius * Math.sin(a)];
        }), kind);
      [["NIS", numbers.nis, settings.nisBounds, "published"], ["NEES", numbers.nees, settings.neesBounds, "ours"]].forEach(([name, value, bounds, kind], i) => {
        const c = dials[i], shown = value ?? Infinity, a = turn(shown);
        shapes += arc(c, DIAL.from, DIAL.to, size, "axis") + arc(c, ...bounds, size - 4, `sensor-3 band`);
        for (const t of [0.1, 1, 10, 100, 1000, 10000, 100000]) {
          const b = turn(t), [cos, sin] = [Math.cos(b), Math.sin(b)];
          shapes += draw.line([c[0] + size * cos, c[1] - size * sin], [c[0] + (size - 6) * cos, c[1] - (size - 6) * sin], "axis");
        }
        shapes += draw.arrow(c, [c[0] + (size - 10) * Math.cos(a), c[1] - (size - 10) * Math.sin(a)], kind);
        shapes += draw.dot(c, 4, "truth filled");
        const words = `${name} ${value === null ? "∞" : value < 100 ? draw.number(value, 1) : draw.brief(Math.round(value))}`;
        shapes += wide
          ? draw.text([c[0] - size - 10, c[1] - 22], name, "end") + draw.text([c[0] - size - 10, c[1] - 4], words.slice(name.length + 1), "end", "bold")
          : draw.text([c[0], c[1] + 20], words, "middle", "bold");
      });

      // Both over time.
      const y = wide ? high + 62 : 2 * high + 190;
      const panel = draw.panel(
        { x: 44, y, width: width - 56, height: 130 },
        { from: 0, to: settings.samples * settings.T, ticks: [0, 0.2, 0.4, 0.6, 0.8, 1], label: "time (s)" },
        { from: 0.5, to: 5000, log: true, ticks: [1, 6, 100, 1000] });
      shapes += panel.frame();
      const curve = (values, kind) => draw.path(
        every.slice(-values.length).map((i, n) => panel.to((i + 1) * settings.T, values[n] || 1e9)), kind);
      shapes += curve(nis, "published thick") + curve(nees, "ours thick");
      shapes += draw.box(44, y - 22, 12, 12, "published filled") + draw.text([60, y - 11], "NIS");
      shapes += draw.box(104, y - 22, 12, 12, "ours filled") + draw.text([120, y - 11], "NEES");
      const x = panel.x(numbers.time);
      shapes += draw.line([x, panel.top], [x, panel.bottom], "truth dashed");
      return {
        height: Math.round(panel.bottom + 44), shapes,
        handles: [{
          name: "time", label: "Time", at: [x, panel.bottom], now: numbers.time, text: `${draw.number(numbers.time, 2)} s`,
          move(px) {
            const wanted = Math.round(((px - panel.left) / (panel.right - panel.left)) * every.length);
            const step = Math.abs(px - x) < 6 ? Math.sign(px - x) + every.indexOf(state.k) : wanted - 1;
            return { k: every[Math.min(Math.max(step, every.length - nis.length), every.length - 1)] };
          },
        }],
      };
    },
    say({ neesBounds, nisBounds, runs: count, window }, state, { time, nis, nees, refused, error, claimed }) {
      const judge = (value, [low, high]) =>
        value === null || value > high ? "too large" : value < low ? "too small" : "right";
      const centimeters = (value) => (value === null ? "lost" : `${draw.brief(100 * value)} cm`);
      const gate = state.gate === "none" ? "" : ` The gate has refused ${draw.number(100 * refused, 0)} % of the samples.`;
      return `After ${draw.number(time, 2)} s the errors are ${centimeters(error)}, the filter says ${centimeters(claimed)}. ` +
        `NIS, over ${window} samples of ${count} runs, is ${judge(nis, nisBounds)}; NEES is ${judge(nees, neesBounds)}.${gate}`;
    },
  };
})();
