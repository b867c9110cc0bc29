// Two radars, two circles: where they meet, by how much that errs, and when they do not meet.
"use strict";

explorables.circles = (() => {
  const RANGE = { x: [-1.7, 1.7], y: [-0.5, 5.2] }; // m
  const REACH = { x: [-1.5, 1.5], y: [0.3, 5] }; // of the person
  const SCANS = 400, SHOWN = 120, DEVIATIONS = 2, RINGS = 3;
  const clamp = (value, [low, high]) => Math.min(Math.max(value, low), high);
  const cents = (value) => Math.round(100 * value) / 100 + 0;

  // Standard deviation of a range: it grows as the echo gets weaker, by so many decibels a meter.
  const deviation = ({ resolution, snr, slope }, d) =>
    resolution / Math.sqrt(2 * 10 ** ((snr - slope * d) / 10));

  function bilaterate(d1, d2, b) {
    const x = (d1 * d1 - d2 * d2) / (2 * b), square = d2 * d2 - (x - b / 2) ** 2;
    return square < 0 ? null : [x, Math.sqrt(square)];
  }

  let kept = null;
  function numbersOf(seed) {
    if (kept?.seed === seed) return kept.pairs;
    const normal = algebra.normal(seed);
    kept = { seed, pairs: Array.from({ length: SCANS }, () => [normal(), normal()]) };
    return kept.pairs;
  }

  return {
    bilaterate,
    start: ({ baseline }) => ({ x: 0.4, y: 3.6, baseline, seed: 1 }),
    controls: () => [
      { name: "x", label: "person x", min: REACH.x[0], max: REACH.x[1], step: 0.05, text: (v) => `${draw.number(v, 2)} m` },
      { name: "y", label: "person y", min: REACH.y[0], max: REACH.y[1], step: 0.05, text: (v) => `${draw.number(v, 2)} m` },
      { name: "baseline", label: "baseline", min: 0.2, max: 3, step: 0.1, text: (v) => `${draw.number(v, 1)} m` },
      { kind: "button", name: "noise", label: "new noise", press: (state) => ({ seed: state.seed + 1 }) },
    ],
    measure(settings, { x, y, baseline: b, seed }) {
      const lines = [[x + b / 2, y], [x - b / 2, y]];
      const ranges = lines.map(([u, v]) => Math.hypot(u, v));
      const deviations = ranges.map((d) => deviation(settings, d));
      const J = [[0, 0], [0, 0]];
      lines.forEach((line, n) => {
        for (let i = 0; i < 2; i++) for (let j = 0; j < 2; j++) {
          J[i][j] += (line[i] * line[j]) / (ranges[n] * deviations[n]) ** 2;
        }
      });
      const P = algebra.inverse(J);
      const points = numbersOf(seed).map(([n1, n2]) =>
        bilaterate(ranges[0] + deviations[0] * n1, ranges[1] + deviations[1] * n2, b));
      return {
        ranges, deviations, covariance: P,
        across: Math.sqrt(P[0][0]), along: Math.sqrt(P[1][1]),
        missed: points.filter((p) => p === null).length / points.length,
        points: points.slice(0, SHOWN),
      };
    },
    draw(settings, state, { ranges, deviations, covariance, points, across, along, missed }, width) {
      const wide = width >= 600, sceneWidth = wide ? Math.round(0.62 * width) : width;
      const scale = sceneWidth / (RANGE.y[1] - RANGE.y[0]), height = Math.round(scale * (RANGE.x[1] - RANGE.x[0]));
      // The person walks to the right; the radars stand at the left, one above the other.
      const place = ([x, y]) => [(y - RANGE.y[0]) * scale, (RANGE.x[1] - x) * scale];
      const back = (px, py) => [RANGE.x[1] - py / scale, px / scale + RANGE.y[0]];
      const radars = [[-state.baseline / 2, 0], [state.baseline / 2, 0]];
      const arc = (center, radius) =>
        Array.from({ length: 91 }, (_, i) => {
          const a = (Math.PI * i) / 90;
          return place([center[0] + radius * Math.cos(a), center[1] + radius * Math.sin(a)]);
        });
      let shapes = `<clipPath id="walk"><rect width="${sceneWidth}" height="${height}"/></clipPath><g clip-path="url(#walk)">`;
      radars.forEach((radar, n) => {
        const kind = n ? "sensor-4" : "sensor-2", wide3 = RINGS * deviations[n];
        const inner = arc(radar, Math.max(ranges[n] - wide3, 0)).reverse();
        shapes += draw.path([...arc(radar, ranges[n] + wide3), ...inner], `${kind} filled pale`, true);
        shapes += draw.path(arc(radar, ranges[n]), kind);
      });
      for (const p of points) if (p) shapes += draw.dot(place(p), 2, "ours filled pale");
      const ring = algebra.ellipse(covariance, DEVIATIONS);
      shapes += draw.path(ring.map(([a, b]) => place([state.x + a, state.y + b])), "ours thick", true) + "</g>";
      radars.forEach((radar, n) => {
        const at = place(radar);
        shapes += draw.dot(at, 7, `sensor-${n ? 4 : 2} filled`) + draw.text([at[0] - 10, at[1] + 5], n + 1, "end");
      });
      const person = place([state.x, state.y]);
      shapes += draw.box(person[0] - 6, person[1] - 6, 12, 12, "truth filled");
      const bar = [sceneWidth - 8 - scale, sceneWidth - 8].map((a) => [a, height - 8]);
      shapes += draw.line(...bar, "axis") + draw.text([bar[1][0], height - 15], "1 m", "end");

      const left = wide ? sceneWidth + 22 : 0, top = wide ? 8 : height + 18, long = width - left - 64;
      const rows = [
        ["range of radar 1", deviations[0], "sensor-2"], ["range of radar 2", deviations[1], "sensor-4"],
        ["position, outwards", along, "ours"], ["position, across", across, "ours"],
      ];
      rows.forEach(([words, value, kind], i) => {
        const y = top + 16 + 44 * i;
        shapes += draw.text([left, y], `${words}`) + draw.box(left, y + 6, Math.min(value, 1) * long, 12, `${kind} filled`);
        shapes += draw.text([left + Math.min(value, 1) * long + 6, y + 17], `${draw.brief(100 * value)} cm`);
      });
      shapes += draw.text([left, top + 200], `no intersection: ${draw.number(100 * missed, 0)} % of ${SCANS} scans`);
      return {
        height: Math.max(height, top + 212), shapes,
        handles: [
          ...radars.map((radar, n) => ({
            name: `radar-${n + 1}`, label: `Radar ${n + 1}`, at: place(radar), now: state.baseline,
            text: `baseline ${draw.number(state.baseline, 1)} m`,
            move(px, py) {
              const b = 2 * (n ? 1 : -1) * back(px, py)[0];
              return { baseline: Math.round(10 * clamp(b, [0.2, 3])) / 10 };
            },
          })),
          {
            name: "person", label: "Person", at: person, now: state.y,
            text: `x ${draw.number(state.x, 2)} m, y ${draw.number(state.y, 2)} m`,
            move(px, py) {
              const [x, y] = back(px, py);
              return { x: cents(clamp(x, REACH.x)), y: cents(clamp(y, REACH.y)) };
            },
          },
        ],
      };
    },
    say(settings, state, { ranges, deviations, across, along, missed }) {
      const worse = across / Math.max(...deviations);
      return `At ${draw.number(Math.hypot(state.x, state.y), 1)} m a range has a deviation of ` +
        `${draw.brief(100 * Math.max(...deviations))} cm, and the position one of ${draw.brief(100 * along)} cm outwards and ` +
        `${draw.brief(100 * across)} cm across, ${draw.number(worse, 1)} times that of the range. ` +
        `The circles do not meet in ${draw.number(100 * missed, 0)} % of the scans.`;
    },
  };
})();
