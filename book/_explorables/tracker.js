// The filter of the library, made of the printed kernels, for records of a few hundred samples.
"use strict";

const tracker = (() => {
  // Places in the 21 factors of what the time update changes, and of what it needs besides.
  const CHANGED = [3, 4, 5, 9, 10, 14], NEEDED = [16, 17, 19];
  const ZERO = [0, 0, 0, 0, 0, 0];

  // Upper triangle of U, where P = U D U', row by row; D stands where U has ones.
  function factored(P) {
    const rest = P.map((row) => [...row]), U = P.map((row) => [...row]);
    for (let j = 5; j >= 0; j--) {
      U[j][j] = rest[j][j];
      for (let i = 0; i < j; i++) U[i][j] = rest[i][j] / rest[j][j];
      for (let i = 0; i < j; i++) {
        for (let k = 0; k <= i; k++) rest[k][i] -= U[k][j] * U[i][j] * rest[j][j];
      }
    }
    return U.flatMap((row, i) => row.slice(i));
  }

  function square(upper) {
    const P = Array.from({ length: 6 }, () => Array(6));
    let place = 0;
    for (let i = 0; i < 6; i++) for (let j = i; j < 6; j++) P[i][j] = P[j][i] = upper[place++];
    return P;
  }

  // States, NIS, whether the gate let a sample in, and the covariance of a sample, which is not
  // wanted of all. `noise`: columns of process noise; `variance`: of a measurement of sample k;
  // `seen`: what the filter makes of an innovation and its gradient.
  function run(start, z, { sensors, perSpeed, T, noise, variance, gate, seen = (one) => one }) {
    const [lower, upper] = gate ?? [-Infinity, Infinity];
    let { x } = start, factors = factored(start.P);
    const kept = [], found = { x: [], nis: [], updated: [] };
    z.forEach((measured, k) => {
      const inputs = [...CHANGED, ...NEEDED].map((i) => factors[i]);
      const [px, py, pz, ...changed] = kernels.predict(...x, ...inputs, T);
      x = [px, py, pz, ...x.slice(3)];
      CHANGED.forEach((i, n) => (factors[i] = changed[n]));
      for (const g of noise) factors = kernels.add_noise.apply(null, factors.concat(g));
      let after = factors, correction = ZERO, nis = 0;
      const rows = sensors.map((s, n) => seen(kernels.linearize(...x, measured[n], ...s, perSpeed)));
      for (const one of rows) {
        const out = kernels.update.apply(null, after.concat(correction, nis, one, variance(k)));
        after = out.slice(0, 21);
        correction = out.slice(21, 27);
        nis = out[27];
      }
      const updated = lower <= nis && nis <= upper;
      if (updated) {
        x = x.map((value, i) => value + correction[i]);
        factors = after;
      }
      found.x.push(x);
      kept.push(factors);
      found.nis.push(nis);
      found.updated.push(updated);
    });
    return { ...found, P: (k) => square(kernels.covariance.apply(null, kept[k])) };
  }

  const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

  function median(values) {
    const sorted = [...values].sort((a, b) => a - b), half = sorted.length >> 1;
    return sorted.length % 2 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
  }

  // NEES of some runs at each of some samples, and the mean NIS of the `window` samples before it.
  function judged(records, every, window, average) {
    return {
      nees: every.map((k) => average(records.map(({ P, error }) => algebra.distance(P(k), error[k])))),
      nis: every.filter((k) => k + 1 >= window).map((k) =>
        average(records.map(({ nis }) => mean(nis.slice(k + 1 - window, k + 1))))),
    };
  }

  const diagonal = (variances) => variances.map((v, i) => variances.map((_, j) => (i === j ? v : 0)));

  return { run, judged, mean, median, diagonal };
})();
