// A filter that failed: three causes to repair, and what its track, its errors and NIS make of it.
"use strict";

explorables.repairs = (() => {
  const SIDE = { x: [-0.42, 0.98], y: [-0.28, 0.28] }; // m, of both views
  const CLOSE = 0.05; // m: a track that follows the mirror image
  const LOG = (from, to, ticks) => ({ from, to, log: true, ticks });

  const place = ({ x0, T }, k) => x0.map((value, i) => (i < 3 ? value + k * T * x0[i + 3] : value));

  // A record after the samples that the start has used, and the filter that follows it.
  function record(settings, state, run) {
    const { perSpeed, T, sigmaA, sigmaF, columns, samples, planes, P0 } = settings;
    const plane = planes[state.ring ? "x" : "z"], { used, x, P } = plane.starts[state.start];
    const normal = algebra.normal(1000 * state.seed + run);
    const truth = Array.from({ length: samples - used }, (_, k) => place(settings, used + k));
    const z = truth.map((one) =>
      plane.sensors.map((s) => kernels.doppler_shift(...one, ...s, perSpeed)[0] + sigmaF * normal()));
    const found = tracker.run({ x: x[run], P: P?.[run] ?? tracker.diagonal(Array(6).fill(P0)) }, z, {
      sensors: plane.sensors, perSpeed, T,
      noise: columns.map((column) => column.map((value) => sigmaA * value)),
      variance: () => sigmaF ** 2,
      // The report's sign: the derivative by the line of sight, not by the position.
      seen: state.sign ? undefined : ([innovation, ...h]) => [innovation, ...h.map((value, i) => (i < 3 ? -value : value))],
    });
    return { z, first: x[run], ...found, error: found.x.map((one, k) => one.map((value, i) => value - truth[k][i])) };
  }

  const size = (e) => Math.hypot(e[0], e[1], e[2]);

  // All runs of a setting; moving along time asks for nothing new.
  let last = null;
  function runs(settings, state) {
    const { k, ...knobs } = state, key = JSON.stringify(knobs);
    if (last?.key === key) return last;
    const plane = settings.planes[state.ring ? "x" : "z"], { used, x } = plane.starts[state.start];
    const records = x.map((_, run) => record(settings, state, run));
    const every = [];
    for (let i = used - 1 + settings.every; i < settings.samples; i += settings.every) every.push(i);
    const own = every.map((i) => i - used);
    const { nis, nees } = tracker.judged(records, own, settings.every, tracker.median);
    const error = own.map((i) => tracker.median(records.map((one) => size(one.error[i]))));
    return (last = { key, used, plane, records, every, nis, nees, error });
  }

  return {
    record,
    start: ({ samples }) => ({ sign: false, ring: false, start: "one descent", k: samples - 1, seed: 1 }),
    controls: ({ samples, every, T, planes }) => [
      { kind: "switch", name: "sign", label: "sign repaired" },
      { kind: "switch", name: "ring", label: "ring of the paper" },
      {
        kind: "choice", name: "start", label: "start",
        options: Object.keys(planes.z.starts).map((name) => [name, name]),
      },
      { kind: "play", name: "k", label: "time", min: 100 + every - 1, max: samples - 1, step: every, text: (v) => `${draw.number((v + 1) * T, 2)} s` },
      { kind: "button", name: "noise", label: "new noise", press: (state) => ({ seed: state.seed + 1 }) },
    ],
    measure(settings, state) {
      const { records, used, every, nis, nees, error } = runs(settings, state);
      const at = every.indexOf(state.k), k = state.k - used;
      const finite = (value) => (Number.isFinite(value) ? value : null);
      const truth = place(settings, state.k);
      const image = records.filter(({ x }) => {
        const [p, q] = [1, -1].map((side) => Math.hypot(x[k][0] - truth[0], x[k][1] - truth[1], side * x[k][2] - truth[2]));
        return q < p && q < CLOSE;
      }).length;
      return {
        time: (state.k + 1) * settings.T, error: finite(error[at]), nis: finite(nis[at]), nees: finite(nees[at]),
        range: tracker.median(records.map(({ x }) => x[k][0])), image: state.ring ? 0 : image,
      };
    },
    draw(settings, state, numbers, width) {
      const { plane, records, used, every, nis, error } = runs(settings, state);
      const wide = width >= 600, views = wide ? Math.round(0.56 * width) : width;
      const scale = views / (SIDE.x[1] - SIDE.x[0]), high = Math.round(scale * (SIDE.y[1] - SIDE.y[0]));
      const past = every.filter((i) => i <= state.k), truth = place(settings, state.k);
      let shapes = "", y = 20;
      const ruler = [views - 10 - 0.2 * scale, views - 10].map((x) => [x, y + high - 8]);
      shapes += draw.line(...ruler, "axis") + draw.text([ruler[1][0], y + high - 14], "0.2 m", "end");
      for (const [name, axis] of [["from above", 1], ["from the side", 2]]) {
        const at = (p) => [(p[0] - SIDE.x[0]) * scale, y + high / 2 - p[axis] * scale];
        const inside = (p) => (p.every(Number.isFinite) && p[0] > 0 && p[0] < views && p[1] > y && p[1] < y + high ? p : [NaN, NaN]);
        shapes += draw.box(0, y, views, high, "frame") + draw.text([6, y - 5], name);
        const path = [used, settings.samples].map((k) => place(settings, k));
        shapes += draw.path(path.map(at), "truth dashed");
        if (axis === 2 && !state.ring) {
          const mirrored = path.map(([a, b, c]) => at([a, b, -c]));
          shapes += draw.path(mirrored, "bound dashed") + draw.text([mirrored[0][0] - 6, mirrored[0][1] + 20], "mirror image", "end");
        }
        const track = ({ x, first }) => [first, ...past.map((i) => x[i - used])].map((one) => inside(at(one)));
        records.forEach((one) => (shapes += draw.path(track(one), "ours thin")));
        shapes += draw.path(track(records[0]), "ours thick");
        plane.sensors.forEach((s, n) => (shapes += draw.dot(at(s), 5, `sensor-${n} filled`)));
        const [tx, ty] = at(truth), ends = inside(at(records[0].x[state.k - used]));
        shapes += draw.box(tx - 6, ty - 6, 12, 12, "truth filled");
        if (Number.isFinite(ends[0])) shapes += draw.dot(ends, 6, "ours filled");
        y += high + 30;
      }
      const x = wide ? views + 56 : 48, across = width - x - 10;
      const time = { from: 0, to: settings.samples * settings.T, ticks: [0, 0.5, 1] };
      const below = y;
      y = wide ? 30 : y + 22;
      const errors = draw.panel({ x, y, width: across, height: 110 }, { ...time, names: false }, LOG(1e-4, 5, [0.001, 0.01, 0.1, 1]));
      const tests = draw.panel({ x, y: errors.bottom + 40, width: across, height: 120 }, { ...time, label: "time (s)" }, LOG(1, 1e6, [6, 100, 1e4]));
      shapes += errors.frame() + draw.text([x, y - 9], "position error (m)");
      shapes += tests.frame() + draw.text([x, tests.top - 9], "NIS, 6 is right");
      const curve = (panel, values, kind) => draw.path(every.map((i, n) => panel.to((i + 1) * settings.T, Number.isFinite(values[n]) ? values[n] : 1e9)), kind);
      records.forEach((one) => (shapes += curve(errors, every.map((i) => size(one.error[i - used])), "ours thin pale")));
      shapes += curve(errors, error, "ours thick") + curve(tests, nis, "ours thick");
      shapes += draw.line(tests.to(0, 6), tests.to(time.to, 6), "bound dashed");
      const told = errors.to(time.to, settings.told.error);
      shapes += draw.dot(told, 5, "published filled") + draw.text([told[0] - 10, told[1] - 8], "report", "end");
      const now = errors.x(numbers.time);
      shapes += draw.line([now, errors.top], [now, tests.bottom], "truth dashed");
      return { height: Math.round(Math.max(tests.bottom + 44, below)), shapes };
    },
    say({ told, planes }, state, { time, error, nis, nees, image }) {
      const count = planes.z.starts[state.start].x.length;
      const length = (value) => (value === null ? "lost" : value < 0.1 ? `${draw.brief(100 * value)} cm` : `${draw.number(value, 2)} m`);
      const judged = (value, right, words) =>
        value === null || value > 2 * right ? `${draw.brief(value ?? Infinity)}: ${words}` : `${draw.brief(value)}: as it should be`;
      const left = state.sign || state.ring || state.start !== "one descent" ? "" : ` (the report ends with ${length(told.error)})`;
      const mirrored = image ? ` ${image} of ${count} runs follow the mirror image.` : "";
      return `After ${draw.number(time, 2)} s the position error is ${length(error)}${left}. NIS is ${judged(nis, 6, "an alarm")}; ` +
        `NEES, which needs the truth, is ${judged(nees, told.nees, "the filter is too sure")}.${mirrored}`;
    },
  };
})();
