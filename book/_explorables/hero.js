// The whole book in one picture: shifts of a target, ten runs of a filter, what they say, and whether to stop.
"use strict";

explorables.hero = (() => {
  const AZIMUTH = (-62 * Math.PI) / 180, ELEVATION = (16 * Math.PI) / 180; // as in the figure of the tracks
  const FLOOR = -0.27; // m
  const SIGHT = { right: [-0.17, 1.01], up: [-0.45, 0.24] }; // m, of the scene

  const view = ([x, y, z]) => [
    -Math.sin(AZIMUTH) * x + Math.cos(AZIMUTH) * y,
    -Math.sin(ELEVATION) * (Math.cos(AZIMUTH) * x + Math.sin(AZIMUTH) * y) + Math.cos(ELEVATION) * z,
  ];
  const clamp = (value, most) => Math.round(1000 * Math.min(Math.max(value, -most), most)) / 1000;

  // Straight on, turned sideways so that it passes the middle elsewhere.
  function path({ x0, T, samples }, { aside }) {
    const v = x0.slice(3), arrives = -x0[0] / v[0];
    v[1] += aside / arrives;
    return Array.from({ length: samples }, (_, k) => x0.slice(0, 3).map((p, i) => p + k * T * v[i]).concat(v));
  }
  function closest([first]) {
    const p = first.slice(0, 3), v = first.slice(3), dot = (a, b) => a.reduce((sum, one, i) => sum + one * b[i], 0);
    return Math.sqrt(dot(p, p) - dot(p, v) ** 2 / dot(v, v));
  }

  // What the filter takes for the deviation of a shift: more at the start, and soon the right one.
  const deviation = ({ sigmaF, fades }, { raise }, k) => sigmaF * (1 + (10 ** raise - 1) * Math.exp(-k / fades));

  function record(settings, state, truth, run) {
    const { sensors, perSpeed, T, sigmaA, sigmaF, columns, error } = settings;
    const normal = algebra.normal(1000 * state.seed + run);
    const z = truth.map((x) => sensors.map((s) => kernels.doppler_shift(...x, ...s, perSpeed)[0] + sigmaF * normal()));
    const [dx, dz] = [state.dx, state.dz], off = [dx, error[1], dz, ...error.slice(3)];
    const estimate = truth[0].map((value, i) => value + off[i]);
    const x = estimate.map((value, i) => (i < 3 ? value - T * estimate[i + 3] : value));
    const found = tracker.run({ x, P: tracker.diagonal(Array(6).fill(10 ** (2 * state.P0))) }, z, {
      sensors, perSpeed, T,
      noise: columns.map((column) => column.map((value) => sigmaA * value)),
      variance: (k) => deviation(settings, state, k) ** 2,
    });
    return { z, estimate, ...found, error: found.x.map((one, k) => one.map((value, i) => value - truth[k][i])) };
  }

  // Share of the states that an estimate leaves possible whose straight line enters the ball.
  function entering(x, P, { radius, within, normal }) {
    const L = algebra.cholesky(P);
    if (!L) return null;
    const enters = normal.filter((u) => {
      const one = x.map((value, i) => L[i].reduce((sum, l, j) => sum + l * u[j], 0) + value);
      const [p, v] = [one.slice(0, 3), one.slice(3)];
      const [pp, pv, vv] = [[p, p], [p, v], [v, v]].map(([a, b]) => a.reduce((sum, value, i) => sum + value * b[i], 0));
      const ahead = Math.min(pv < 0 ? -pv / vv : 0, within);
      return pp + ahead * (2 * pv + ahead * vv) < radius ** 2;
    });
    return enters.length / normal.length;
  }

  const centimeters = (value) => (value === null ? "lost" : `${draw.brief(100 * value)} cm`);
  const size = (e) => Math.hypot(e[0], e[1], e[2]);
  const spread = (P) => Math.sqrt(P[0][0] + P[1][1] + P[2][2]);

  // All runs of a setting; moving along time asks for nothing new.
  let last = null;
  function runs(settings, state) {
    const { k, ...knobs } = state, key = JSON.stringify(knobs);
    if (last?.key === key) return last;
    const truth = path(settings, state);
    const records = Array.from({ length: settings.runs }, (_, run) => record(settings, state, truth, run));
    const every = Array.from({ length: settings.samples / settings.every }, (_, i) => (i + 1) * settings.every - 1);
    return (last = {
      key, truth, records, every,
      ...tracker.judged(records, every, settings.window, tracker.median),
      error: every.map((i) => tracker.median(records.map(({ error }) => size(error[i])))),
      claimed: every.map((i) => tracker.median(records.map(({ P }) => spread(P(i))))),
    });
  }

  const PUBLISHED = { P0: -0.5, raise: 0 };
  return {
    path, record, deviation, entering,
    start: ({ error, every }) => ({ k: 75 * every - 1, dx: error[0], dz: error[2], P0: -0.5, raise: 1.5, aside: 0, seed: 1 }),
    controls: ({ samples, every, window, T }) => [
      { kind: "play", name: "k", label: "time", min: window - 1, max: samples - 1, step: every, text: (v) => `${draw.number((v + 1) * T, 2)} s` },
      { name: "raise", label: "noise, at first", min: 0, max: 2, step: 0.1, text: (v) => `× ${draw.brief(10 ** v)}` },
      { name: "P0", label: "P0 deviation", min: -2, max: 0, step: 0.1, text: (v) => `${draw.brief(100 * 10 ** v)} cm` },
      { name: "aside", label: "passes aside", min: -0.3, max: 0.3, step: 0.01, text: (v) => `${draw.number(100 * v, 0)} cm` },
      { kind: "button", name: "published", label: "filter as published", press: () => PUBLISHED },
      { kind: "button", name: "noise", label: "new noise", press: (state) => ({ seed: state.seed + 1 }) },
    ],
    measure(settings, state) {
      const { truth, records, every, nees, nis, error, claimed } = runs(settings, state);
      const at = every.indexOf(state.k), finite = (value) => (Number.isFinite(value) ? value : null);
      const chances = records.map(({ x, P }) => entering(x[state.k], P(state.k), settings));
      return {
        time: (state.k + 1) * settings.T, error: finite(error[at]), claimed: finite(claimed[at]),
        nis: finite(nis[at - every.length + nis.length]), nees: finite(nees[at]),
        chances, stops: chances.filter((chance) => chance > settings.threshold).length, closest: closest(truth),
      };
    },
    draw(settings, state, numbers, width) {
      const { truth, records, every, error, claimed } = runs(settings, state);
      const { sensors, runs: count, samples, T, neesMedian } = settings;
      const wide = width >= 600, sceneWidth = wide ? Math.round(0.62 * width) : width;
      const scale = sceneWidth / (SIGHT.right[1] - SIGHT.right[0]);
      const sceneHeight = Math.round(scale * (SIGHT.up[1] - SIGHT.up[0]));
      const place = (p) => {
        const [right, up] = view(p);
        return [(right - SIGHT.right[0]) * scale, (SIGHT.up[1] - up) * scale];
      };
      const within = (p) => (p.every(Number.isFinite) && p[0] > 0 && p[0] < sceneWidth && p[1] > 0 && p[1] < sceneHeight ? p : [NaN, NaN]);

      // Floor, ring and path.
      let shapes = "";
      for (let x = 0; x < 1.05; x += 0.2) shapes += draw.line(place([x, -0.2, FLOOR]), place([x, 0.2, FLOOR]), "grid");
      for (const y of [-0.2, 0, 0.2]) shapes += draw.line(place([0, y, FLOOR]), place([1, y, FLOOR]), "grid");
      for (const x of [0, 0.5, 1]) {
        const [a, b] = place([x, -0.2, FLOOR]);
        shapes += draw.text([a, b + 17], `${x} m`, "middle");
      }
      const radius = Math.hypot(...sensors[0]);
      const circle = Array.from({ length: 49 }, (_, i) => [0, radius * Math.cos((i * Math.PI) / 24), radius * Math.sin((i * Math.PI) / 24)]);
      shapes += draw.path(circle.map(place), "sensor-3 band pale");
      sensors.forEach((s, n) => (shapes += draw.dot(place(s), 6, `sensor-${n} filled`)));
      const k = state.k, past = every.filter((i) => i <= k), few = past.filter((_, n) => n % 2 === 0);
      records.forEach(({ x, estimate }) => {
        shapes += draw.path([estimate, ...few.map((i) => x[i])].map((one) => within(place(one))), "ours pale thin");
      });
      shapes += draw.path([truth[0], truth.at(-1)].map(place), "truth dashed");
      const [run] = records;
      shapes += draw.path([run.estimate, ...past.map((i) => run.x[i])].map((one) => within(place(one))), "ours thick");

      // Ellipses of 95 % as they are seen: the covariance of the two coordinates of the view.
      const axes = [view([1, 0, 0]), view([0, 1, 0]), view([0, 0, 1])];
      const seen = (P) => [0, 1].map((a) => [0, 1].map((b) =>
        axes.reduce((sum, one, i) => sum + axes.reduce((more, two, j) => more + one[a] * P[i][j] * two[b], 0), 0)));
      for (const i of [...past.filter((one) => (one + 1) % settings.window === 0 && one < k), k]) {
        const middle = place(run.x[i]);
        const ring = algebra.ellipse(seen(run.P(i)), Math.sqrt(settings.disc95));
        const inside = ([a, b]) => [
          Math.min(Math.max(middle[0] + a * scale, 0), sceneWidth), Math.min(Math.max(middle[1] - b * scale, 0), sceneHeight)];
        if (ring.flat().every(Number.isFinite)) shapes += draw.path(ring.map(inside), i === k ? "ours region" : "ours thin", true);
      }
      const target = place(truth[k]), start = place(run.estimate);
      shapes += draw.box(target[0] - 6, target[1] - 6, 12, 12, "truth filled");
      shapes += draw.dot(start, 6, "published filled");
      shapes += draw.text([Math.min(start[0], sceneWidth - 56), Math.max(start[1] - 20, 14)], "first estimate", "middle");

      // The decision, and what the filter says beside what is true.
      let y = sceneHeight + 30;
      const stop = 2 * numbers.stops > count, sign = [36, y + 16];
      const corners = (r) => Array.from({ length: 8 }, (_, i) => {
        const angle = ((i + 0.5) * Math.PI) / 4;
        return [sign[0] + r * Math.cos(angle), sign[1] + r * Math.sin(angle)];
      });
      shapes += draw.path(corners(34), stop ? "published filled" : "axis", true);
      shapes += draw.text([sign[0], sign[1] + 5], stop ? "STOP" : "go on", "middle", stop ? "bold sign" : undefined);
      const judged = (value) => (value === null ? "∞" : draw.brief(value));
      const pairs = [
        [`error ${centimeters(numbers.error)}`, `the filter says ${centimeters(numbers.claimed)}`],
        [`NIS ${judged(numbers.nis)} (right: 6)`, `NEES ${judged(numbers.nees)} (right: ${draw.number(neesMedian, 1)})`],
        [`${numbers.stops} of ${count} runs stop`],
      ];
      const words = width < 400 ? pairs.flat() : pairs.map((pair) => pair.join(", "));
      words.forEach((line, i) => (shapes += draw.text([84, y + 2 + 19 * i], line)));
      const below = y + 19 * words.length + 13; // as high as the sign, with three lines

      // Measured shifts, and errors.
      const x = wide ? sceneWidth + 44 : 44, across = width - x - 10;
      const time = { from: 0, to: samples * T, ticks: [0, 0.5, 1] };
      y = wide ? 26 : below + 18;
      const shifts = draw.panel({ x, y, width: across, height: 104 }, { ...time, names: false }, { from: 0, to: 130, ticks: [0, 50, 100] });
      shapes += shifts.frame() + draw.text([x, y - 9], "measured: six shifts (Hz)");
      sensors.forEach((_, n) => (shapes += draw.path(past.map((i) => shifts.to((i + 1) * T, run.z[i][n])), `sensor-${n}`)));
      const panel = draw.panel(
        { x, y: shifts.bottom + 34, width: across, height: 112 }, { ...time, label: "time (s)" },
        { from: 0.02, to: 50, log: true, ticks: [0.1, 1, 10] });
      shapes += panel.frame() + draw.text([x, panel.top - 9], "error, dashed: claimed (cm)");
      records.forEach(({ error: one }) => {
        shapes += draw.path(every.filter((_, n) => n % 3 === 0).map((i) => panel.to((i + 1) * T, 100 * size(one[i]))), "ours pale thin");
      });
      shapes += draw.path(every.map((i, n) => panel.to((i + 1) * T, 100 * error[n])), "ours thick");
      shapes += draw.path(every.map((i, n) => panel.to((i + 1) * T, 100 * claimed[n])), "published claimed");
      const now = panel.x(numbers.time);
      shapes += draw.line([now, shifts.top], [now, panel.bottom], "truth dashed");
      return {
        height: Math.round(Math.max(panel.bottom + 44, below)), shapes,
        handles: [{
          name: "start", label: "First estimate", at: start, now: state.dx,
          text: `${draw.number(100 * state.dx, 1)} cm off in x, ${draw.number(100 * state.dz, 1)} cm in z`,
          move(px, py) {
            const right = (px - start[0]) / scale, up = (start[1] - py) / scale;
            const [[a, b], [, d]] = [axes[0], axes[2]], dx = right / a;
            return { dx: clamp(state.dx + dx, 0.15), dz: clamp(state.dz + (up - b * dx) / d, 0.15) };
          },
        }],
      };
    },
    say({ runs: count, threshold, within }, state, { time, error, claimed, nis, stops, closest }) {
      const hits = closest < 0.1 ? "hits the machine" : "passes it";
      const judged = error === null || error > 2 * claimed ? "The filter does not know how wrong it is" : "The filter knows how wrong it may be";
      const looks = nis !== null && Math.abs(nis - 6) < 1.5 ? ", and its innovations look right" : "";
      return `After ${draw.number(time, 2)} s the error is ${centimeters(error)}, the filter says ${centimeters(claimed)}. ${judged}${looks}. ` +
        `${stops} of ${count} runs stop: in each the probability of a collision within ${within} s is above ${threshold}. The target ${hits}: it comes as near as ${draw.number(100 * closest, 0)} cm.`;
    },
  };
})();
