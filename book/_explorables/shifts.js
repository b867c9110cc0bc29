// A plane scene: what each sensor measures, where it lets the target be, and what all bound.
"use strict";

explorables.shifts = (() => {
  const RANGE = { x: [-0.12, 1.05], y: [-0.48, 0.48] }; // m
  const REACH = { x: [0.05, 1], y: [-0.45, 0.45] }; // of the target
  const ARROW = 0.25; // m drawn for 1 m/s
  const DEVIATIONS = 2, LARGER = 10; // of the ellipse; it is drawn ten times as large
  const clamp = (value, [low, high]) => Math.min(Math.max(value, low), high);
  const cents = (value) => Math.round(100 * value) / 100 + 0;
  const row = (length, n) =>
    Array.from({ length: n }, (_, i) => [0, cents(length * (i / (n - 1) - 0.5))]);

  // The slider of the row's length puts all sensors back in line.
  const inRow = (length, { sensors }) => ({ length, sensors: row(length, sensors.length) });

  const velocity = ({ speed, direction }) => {
    const angle = (direction * Math.PI) / 180;
    return [speed * Math.cos(angle), speed * Math.sin(angle)];
  };

  // Information on x, y, v_x and v_y from samples of straight motion.
  function information({ perSpeed, T, samples, deviation }, state) {
    const [vx, vy] = velocity(state);
    const J = [0, 1, 2, 3].map(() => [0, 0, 0, 0]);
    for (let k = 0; k < samples; k++) {
      const t = k * T;
      for (const [sx, sy] of state.sensors) {
        const [, hx, hy, , hvx, hvy] = kernels.doppler_shift_and_gradient(
          state.x + t * vx, state.y + t * vy, 0, vx, vy, 0, sx, sy, 0, perSpeed);
        const h = [hx, hy, hvx + t * hx, hvy + t * hy];
        for (let i = 0; i < 4; i++) for (let j = 0; j < 4; j++) J[i][j] += h[i] * h[j];
      }
    }
    return J.map((line) => line.map((value) => value / deviation ** 2));
  }

  return {
    start: ({ sensors, x }) => ({
      x: x[0], y: x[1], speed: cents(Math.hypot(x[3], x[4])),
      direction: Math.round((Math.atan2(x[4], x[3]) * 180) / Math.PI),
      length: cents(sensors.at(-1)[1] - sensors[0][1]),
      sensors: sensors.map(([a, b]) => [a, b]),
    }),
    controls: () => [
      { name: "x", label: "target x", min: REACH.x[0], max: REACH.x[1], step: 0.01, text: (v) => `${draw.number(v, 2)} m` },
      { name: "y", label: "target y", min: REACH.y[0], max: REACH.y[1], step: 0.01, text: (v) => `${draw.number(v, 2)} m` },
      { name: "speed", label: "speed", min: 0, max: 2, step: 0.01, text: (v) => `${draw.number(v, 2)} m/s` },
      { name: "direction", label: "direction", min: -180, max: 180, step: 1, text: (v) => `${draw.number(v, 0)}°` },
      { name: "length", label: "row length", min: 0.1, max: 0.9, step: 0.02, text: (v) => `${draw.number(v, 2)} m`, set: inRow },
    ],
    measure(settings, state) {
      const [vx, vy] = velocity(state);
      const shifts = state.sensors.map(([sx, sy]) =>
        kernels.doppler_shift(state.x, state.y, 0, vx, vy, 0, sx, sy, 0, settings.perSpeed)[0]);
      const J = information(settings, state);
      const P = algebra.inverse(J);
      const position = P && [[P[0][0], P[0][1]], [P[1][0], P[1][1]]];
      return {
        x: [state.x, state.y, vx, vy], sensors: state.sensors, shifts, information: J, position,
        bound: P && Math.sqrt(P[0][0] + P[1][1]),
      };
    },
    draw(settings, state, { shifts, position, bound }, width) {
      const wide = width >= 600;
      const sceneWidth = wide ? Math.round(0.68 * width) : width;
      const scale = sceneWidth / (RANGE.x[1] - RANGE.x[0]);
      const height = Math.round(scale * (RANGE.y[1] - RANGE.y[0]));
      const place = (x, y) => [(x - RANGE.x[0]) * scale, (RANGE.y[1] - y) * scale];
      const back = (px, py) => [px / scale + RANGE.x[0], RANGE.y[1] - py / scale];
      const target = place(state.x, state.y), [vx, vy] = velocity(state);
      const tip = place(state.x + ARROW * vx, state.y + ARROW * vy);
      const angle = (state.direction * Math.PI) / 180;

      // Two rays of equal shift leave each sensor: through the target, and mirrored at the velocity.
      let rays = "", marks = "";
      state.sensors.forEach(([sx, sy], n) => {
        const seen = Math.atan2(state.y - sy, state.x - sx), mirrored = 2 * angle - seen;
        const from = place(sx, sy);
        const ray = (a, kind) => draw.line(from, place(sx + 3 * Math.cos(a), sy + 3 * Math.sin(a)), kind);
        if (state.speed > 0) {
          rays += ray(mirrored, `sensor-${n} dashed`) + ray(seen, `sensor-${n}`);
        }
        marks += draw.dot(from, 7, `sensor-${n} filled`) + draw.text([from[0] - 24, from[1] + 5], n + 1, "middle");
      });
      const frame = `<clipPath id="scene"><rect width="${sceneWidth}" height="${height}"/></clipPath>`;
      let shapes = `${frame}<g clip-path="url(#scene)">${rays}`;
      if (position) {
        const ring = algebra.ellipse(position, DEVIATIONS * LARGER);
        shapes += draw.path(ring.map(([a, b]) => place(state.x + a, state.y + b)), "ours region", true);
      }
      shapes += `${marks}${draw.arrow(target, tip, "truth")}</g>`;
      shapes += draw.box(target[0] - 6, target[1] - 6, 12, 12, "truth filled");
      const bar = [sceneWidth - 8 - 0.2 * scale, sceneWidth - 8].map((x) => [x, height - 8]);
      shapes += draw.line(...bar, "axis") + draw.text([bar[1][0], height - 15], "0.2 m", "end");

      const n = shifts.length, left = wide ? sceneWidth + 14 : 0, step = wide ? Math.min((height - 40) / n, 46) : 26;
      const top = wide ? 34 : height + 34, zero = left + (width - left) * 0.62;
      const most = settings.perSpeed * 2, half = (width - left) * 0.38;
      shapes += draw.text([left, top - 12], "Doppler shift (Hz)");
      shifts.forEach((shift, i) => {
        const y = top + (n - 1 - i) * step, long = (half * Math.abs(shift)) / most;
        shapes += draw.box(shift < 0 ? zero - long : zero, y + 3, long, step - 6, `sensor-${i} filled`);
        shapes += draw.text([left, y + step / 2 + 5], i + 1);
        shapes += draw.text([left + (width - left) * 0.235 + 24, y + step / 2 + 5], draw.number(shift, 1), "end");
      });
      shapes += draw.line([zero, top], [zero, top + n * step], "axis");
      return {
        height: Math.max(height, Math.round(top + n * step + 6)), shapes,
        handles: [
          ...state.sensors.map(([sx, sy], i) => ({
            name: `sensor-${i + 1}`, label: `Sensor ${i + 1}`, at: place(sx, sy), now: sy,
            text: `x ${draw.number(sx, 2)} m, y ${draw.number(sy, 2)} m`,
            move(px, py) {
              const [x, y] = back(px, py);
              const moved = [cents(clamp(x, [-0.1, 1])), cents(clamp(y, REACH.y))];
              return { sensors: state.sensors.map((s, j) => (j === i ? moved : s)) };
            },
          })),
          {
            name: "velocity", label: "Tip of the velocity", at: tip, now: state.direction,
            text: `${draw.number(state.speed, 2)} m/s, direction ${state.direction}°`,
            move(px, py) {
              const [x, y] = back(px, py), v = [(x - state.x) / ARROW, (y - state.y) / ARROW];
              return {
                speed: cents(Math.min(Math.hypot(...v), 2)),
                direction: Math.round((Math.atan2(v[1], v[0]) * 180) / Math.PI),
              };
            },
          },
          {
            name: "target", label: "Target", at: target, now: state.x,
            text: `x ${draw.number(state.x, 2)} m, y ${draw.number(state.y, 2)} m`,
            move(px, py) {
              const [x, y] = back(px, py);
              return { x: cents(clamp(x, REACH.x)), y: cents(clamp(y, REACH.y)) };
            },
          },
        ],
      };
    },
    say(settings, state, { shifts, bound }) {
      const spread = Math.max(...shifts) - Math.min(...shifts);
      const apart = `The shifts differ by ${draw.number(spread, 1)} Hz at most.`;
      const seconds = draw.number(settings.samples * settings.T);
      return bound
        ? `${apart} After ${seconds} s no unbiased estimate of the position is better than ${draw.brief(1000 * bound)} mm.`
        : `${apart} They do not tell where the target is.`;
    },
  };
})();
