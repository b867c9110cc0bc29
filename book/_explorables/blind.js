// A walk through the states that a ring of sensors cannot tell apart.
"use strict";

explorables.blind = (() => {
  const RANGE = { x: [-0.17, 1.86], y: [-0.34, 0.62] }; // m
  const ARROW = 0.3; // m drawn for 1 m/s
  const SCALES = Array.from({ length: 151 }, (_, i) => (50 + i) / 100);
  const GAUGE = { from: 1e-15, to: 100, log: true, ticks: [1e-15, 1e-10, 1e-5, 1], names: false };

  const member = ({ x0, radius }, t) => kernels.ring_family_state(...x0, radius, t);
  const lifted = ({ sensors }, lift) =>
    sensors.map(([x, y, z], n) => [n === 0 ? x + lift / 100 : x, y, z]);
  const shiftsOf = ({ perSpeed }, sensors, x) =>
    sensors.map((s) => kernels.doppler_shift(...x, ...s, perSpeed)[0]);

  // Information on all six components from samples of one state.
  function information({ perSpeed, samples, deviation }, sensors, x) {
    const rows = sensors.map((s) => kernels.doppler_shift_and_gradient(...x, ...s, perSpeed).slice(1));
    return x.map((_, i) =>
      x.map((_, j) => (rows.reduce((sum, h) => sum + h[i] * h[j], 0) * samples) / deviation ** 2));
  }

  return {
    start: () => ({ t: 1.5, lift: 0 }),
    controls: () => [
      { name: "t", label: "scale t", min: SCALES[0], max: SCALES.at(-1), step: 0.01, text: (v) => draw.number(v, 2) },
      { name: "lift", label: "sensor 1 lifted", min: 0, max: 20, step: 0.5, text: (v) => `${draw.number(v, 1)} cm` },
    ],
    measure(settings, { t, lift }) {
      const x = member(settings, t), sensors = lifted(settings, lift);
      const shifts = shiftsOf(settings, sensors, x);
      const first = shiftsOf(settings, sensors, settings.x0);
      const change = Math.max(...shifts.map((shift, n) => Math.abs(shift - first[n])));
      // On the ring it is singular, whatever rounding says.
      const P = lift > 0 ? algebra.inverse(information(settings, sensors, x)) : null;
      return {
        x, shifts, first, change,
        information: information(settings, sensors, x),
        bound: P && Math.sqrt(P[0][0] + P[1][1] + P[2][2]),
      };
    },
    draw(settings, { t, lift }, { x, shifts, first, change }, width) {
      const wide = width >= 600;
      const sceneWidth = wide ? Math.round(0.62 * width) : width;
      const scale = sceneWidth / (RANGE.x[1] - RANGE.x[0]);
      const height = Math.round(scale * (RANGE.y[1] - RANGE.y[0]));
      const place = ([a, b]) => [(a - RANGE.x[0]) * scale, (RANGE.y[1] - b) * scale];
      const curve = SCALES.map((s) => place(member(settings, s)));
      let shapes = draw.path(curve, "published dashed");
      lifted(settings, lift).forEach((s, n) => {
        const at = place(s);
        if (n === 0 && lift > 0) shapes += draw.line(place(settings.sensors[0]), at, "axis");
        shapes += draw.dot(at, 6, `sensor-${n} filled`);
      });
      const top = place([0, settings.radius]);
      shapes += draw.text([top[0] - 8, top[1] - 12], "ring", "middle");
      const arrow = (state, kind) => {
        const from = place(state), to = place([state[0] + ARROW * state[3], state[1] + ARROW * state[4]]);
        return draw.arrow(from, to, kind) + draw.box(from[0] - 6, from[1] - 6, 12, 12, `${kind} filled`);
      };
      const start = place(settings.x0);
      shapes += arrow(settings.x0, "bound") + draw.text([start[0] + 2, start[1] + 26], "t = 1", "middle");
      shapes += arrow(x, "truth");
      const ruler = [sceneWidth - 8 - 0.5 * scale, sceneWidth - 8].map((a) => [a, height - 6]);
      shapes += draw.line(...ruler, "axis") + draw.text([ruler[1][0], height - 13], "0.5 m", "end");

      const n = shifts.length, left = wide ? sceneWidth + 20 : 0, most = 150;
      const up = wide ? 34 : height + 36, step = wide ? Math.min((height - 44) / n, 34) : 24;
      const zero = left + 96, long = width - zero - 4;
      shapes += draw.text([left, up - 14], "Doppler shift (Hz)");
      shifts.forEach((shift, i) => {
        const y = up + i * step, at = zero + (long * first[i]) / most;
        shapes += draw.box(zero, y + 3, (long * shift) / most, step - 6, `sensor-${i} filled`);
        shapes += draw.line([at, y], [at, y + step], "published");
        shapes += draw.text([left, y + step / 2 + 5], i + 1);
        shapes += draw.text([left + 84, y + step / 2 + 5], draw.number(shift, 3), "end");
      });
      shapes += draw.line([zero, up], [zero, up + n * step], "axis");

      const below = Math.max(height, up + n * step) + 46;
      const gauge = draw.panel({ x: 8, y: below, width: width - 16, height: 16 }, GAUGE, { from: 0, to: 1 });
      const [end] = gauge.to(Math.max(change, GAUGE.from), 0), noise = gauge.x(settings.deviation);
      shapes += draw.text([8, below - 10], "largest change from t = 1 (Hz)", "start");
      shapes += draw.box(8, below, end - 8, 16, change > settings.deviation ? "published filled" : "ours filled");
      shapes += gauge.frame();
      GAUGE.ticks.forEach((tick, i) => {
        const words = ["10⁻¹⁵", "10⁻¹⁰", "10⁻⁵", "1"][i];
        shapes += draw.text([gauge.x(tick), gauge.bottom + 19], words, i ? "middle" : "start");
      });
      shapes += draw.line([noise, below - 4], [noise, below + 20], "axis thick");
      shapes += draw.text([noise, below - 10], "noise", "middle");
      return {
        height: Math.round(below + 42), shapes,
        handles: [{
          name: "target", label: "Target, along the family", at: place(x), now: t,
          text: `t = ${draw.number(t, 2)}`,
          move(px, py) {
            const far = curve.map(([a, b]) => Math.hypot(a - px, b - py));
            return { t: SCALES[far.indexOf(Math.min(...far))] };
          },
        }],
      };
    },
    say(settings, { t, lift }, { x, change, bound }) {
      const away = `At t = ${draw.number(t, 2)} the target is ${draw.number(Math.hypot(...x.slice(0, 3)), 2)} m away,`;
      const seen = change > settings.deviation
        ? `and a shift changes by ${draw.brief(change)} Hz.`
        : `and no shift changes by more than ${draw.brief(change)} Hz; the noise of one is ${settings.deviation} Hz.`;
      return `${away} ${seen} The bound on its position from ${settings.samples} samples at rest is ${
        bound ? `${draw.brief(100 * bound)} cm` : "infinite"}.`;
    },
  };
})();
