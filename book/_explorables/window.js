// The length of a window: more of it averages noise and blurs motion.
"use strict";

explorables.window = (() => {
  const SIZE = 2048, DRAWS = 60, SPAN = [-150, 300]; // of the transform; Hz around the tone
  const GRID = Array.from({ length: 181 }, (_, i) => SPAN[0] + (i * (SPAN[1] - SPAN[0])) / 180);
  const ERRORS = { from: 0.01, to: 100, log: true, ticks: [0.01, 0.1, 1, 10, 100], label: "error (Hz)" };
  const variance = 6 / (2 * Math.PI) ** 2;

  // Discrete Fourier transform, in place; the length is a power of two.
  function transform(re, im) {
    const n = re.length;
    for (let i = 1, j = 0; i < n; i++) {
      let bit = n >> 1;
      for (; j & bit; bit >>= 1) j ^= bit;
      j ^= bit;
      if (i < j) {
        [re[i], re[j]] = [re[j], re[i]];
        [im[i], im[j]] = [im[j], im[i]];
      }
    }
    for (let half = 1; half < n; half *= 2) {
      for (let k = 0; k < half; k++) {
        const c = Math.cos((Math.PI * k) / half), s = -Math.sin((Math.PI * k) / half);
        for (let i = k; i < n; i += 2 * half) {
          const j = i + half, x = c * re[j] - s * im[j], y = c * im[j] + s * re[j];
          re[j] = re[i] - x;
          im[j] = im[i] - y;
          re[i] += x;
          im[i] += y;
        }
      }
    }
  }

  // Sum of the samples turned back by a frequency, and its derivatives by the angle of a step.
  function turned({ re, im }, step) {
    const sums = [0, 0, 0, 0, 0, 0], n = re.length;
    for (let i = 0; i < n; i++) {
      const t = i - (n - 1) / 2, c = Math.cos(step * t), s = -Math.sin(step * t);
      const x = re[i] * c - im[i] * s, y = re[i] * s + im[i] * c;
      sums[0] += x;
      sums[1] += y;
      sums[2] += t * y;
      sums[3] -= t * x;
      sums[4] -= t * t * x;
      sums[5] -= t * t * y;
    }
    return sums;
  }

  // Highest place of the spectrum: the highest bin of the padded transform, then Newton's method.
  function estimate({ re, im }, fs) {
    const r = new Float64Array(SIZE), m = new Float64Array(SIZE);
    r.set(re);
    m.set(im);
    transform(r, m);
    let best = 0;
    for (let i = 1; i < SIZE; i++) if (r[i] ** 2 + m[i] ** 2 > r[best] ** 2 + m[best] ** 2) best = i;
    let step = (2 * Math.PI * (best < SIZE / 2 ? best : best - SIZE)) / SIZE;
    for (let i = 0; i < 8; i++) {
      const [x, y, dx, dy, ddx, ddy] = turned({ re, im }, step);
      const slope = x * dx + y * dy, bend = dx * dx + dy * dy + x * ddx + y * ddy;
      if (!(bend < 0)) break;
      step -= Math.max(Math.min(slope / bend, Math.PI / SIZE), -Math.PI / SIZE);
    }
    return (step * fs) / (2 * Math.PI);
  }

  // A tone whose frequency at its tag is `tone`, and noise of variance one.
  function samples({ fs, tone }, { length, snr, chirp, bend, tag }, noise) {
    const size = 10 ** (snr / 20), re = new Float64Array(length), im = new Float64Array(length);
    for (let i = 0; i < length; i++) {
      const t = (i - (tag === "end" ? length - 1 : (length - 1) / 2)) / fs;
      const angle = 2 * Math.PI * (tone * t + (chirp * t * t) / 2 + (bend * t ** 3) / 6);
      re[i] = size * Math.cos(angle) + noise[2 * i];
      im[i] = size * Math.sin(angle) + noise[2 * i + 1];
    }
    return { re, im };
  }

  let drawn = null;
  function noises(seed, most) {
    if (drawn?.seed === seed) return drawn.all;
    const normal = algebra.normal(seed);
    const all = Array.from({ length: DRAWS }, () => Float64Array.from({ length: 2 * most }, () => normal() / Math.SQRT2));
    drawn = { seed, all };
    return all;
  }

  // Deviation by the bound, and bias of the tag, for a window of some samples.
  function law({ fs }, { snr, chirp, bend, tag }, length) {
    const T = length / fs, power = 10 ** (snr / 10);
    return {
      noise: Math.sqrt((variance * fs ** 2) / (power * length * (length ** 2 - 1))),
      bias: tag === "end" ? (chirp * T) / 2 : (bend * T ** 2) / 40,
    };
  }
  function best({ fs }, { snr, chirp, bend, tag }) {
    const cn0 = fs * 10 ** (snr / 10);
    return tag === "end"
      ? ((6 * variance) / cn0 / chirp ** 2) ** (1 / 5)
      : ((1200 * variance) / cn0 / bend ** 2) ** (1 / 7);
  }

  return {
    estimate, samples, transform,
    start: ({ lengths, chirp, bend, snr }) => ({ place: lengths.indexOf(401), snr, chirp, bend, tag: "end", seed: 1 }),
    controls: ({ lengths, fs }) => [
      { name: "place", label: "window", min: 0, max: lengths.length - 1, step: 1, text: (v) => `${draw.number((1000 * lengths[v]) / fs, 1)} ms` },
      { name: "snr", label: "SNR", min: -15, max: 30, step: 1, text: (v) => `${draw.number(v)} dB` },
      { name: "chirp", label: "chirp", min: 0, max: 1000, step: 20, text: (v) => `${v} Hz/s` },
      { name: "bend", label: "its change", min: 0, max: 5000, step: 100, text: (v) => `${v} Hz/s²` },
      { kind: "choice", name: "tag", label: "time stamp", options: [["end", "end of the window"], ["center", "center of the window"]] },
      { kind: "button", name: "noise", label: "new noise", press: (state) => ({ seed: state.seed + 1 }) },
    ],
    measure(settings, state) {
      const { fs, tone, lengths } = settings, length = lengths[state.place];
      const all = noises(state.seed, lengths.at(-1)).map((noise) =>
        estimate(samples(settings, { ...state, length }, noise), fs) - tone);
      const { noise, bias } = law(settings, state, length), ideal = best(settings, state);
      return {
        length, estimate: tone + all[0], errors: all, bound: noise, bias,
        rms: Math.sqrt(all.reduce((sum, e) => sum + e * e, 0) / all.length),
        outliers: all.filter((e) => Math.abs(e) > fs / length).length,
        best: Number.isFinite(ideal) ? ideal : null,
      };
    },
    draw(settings, state, numbers, width) {
      const { fs, tone, lengths } = settings, { length } = numbers;
      const wide = width >= 600, half = wide ? width / 2 - 20 : width;
      const window = samples(settings, { ...state, length }, noises(state.seed, lengths.at(-1))[0]);
      const heights = GRID.map((f) => {
        const [x, y] = turned(window, (2 * Math.PI * (tone + f)) / fs);
        return Math.hypot(x, y);
      });
      const top = Math.max(...heights);
      const left = draw.panel(
        { x: 12, y: 62, width: half - 30, height: 190 },
        { from: SPAN[0], to: SPAN[1], ticks: [-100, 0, 100, 200, 300], label: "frequency minus that of the tone (Hz)" },
        { from: 0, to: 1.1, label: "spectrum of one window" });
      let shapes = left.frame() + draw.path(GRID.map((f, i) => left.to(f, heights[i] / top)), "ours thick");
      const off = numbers.estimate - tone, at = left.to(off, 0)[0];
      shapes += draw.line([left.x(0), left.top], [left.x(0), left.bottom], "truth dashed");
      shapes += draw.line([at, left.top], [at, left.bottom], "published thick");
      shapes += draw.box(12, 8, 12, 12, "published filled") + draw.text([30, 19], `estimate, off by ${draw.brief(off)} Hz`);
      const bin = left.x(fs / length) - left.x(0);
      const ruler = [left.right - Math.min(bin, half - 40), left.right].map((x) => [x, left.top + 14]);
      shapes += draw.line(...ruler, "axis thick");
      shapes += draw.text([left.right, left.top + 32], `one bin, ${draw.brief(fs / length)} Hz`, "end");

      const x = wide ? half + 84 : 48, y = wide ? 62 : left.bottom + 106;
      const from = lengths[0] / fs, to = lengths.at(-1) / fs;
      const right = draw.panel(
        { x, y, width: width - x - 10, height: 190 },
        { from: 1000 * from, to: 1000 * to, log: true, ticks: [5, 10, 20, 50], label: "length of the window (ms)" }, ERRORS);
      shapes += right.frame();
      const curve = (what, kind) => draw.path(
        lengths.map((n) => {
          const { noise, bias } = law(settings, state, n);
          const value = { noise, bias, both: Math.hypot(noise, bias) }[what];
          return value < ERRORS.from ? [NaN, NaN] : right.to((1000 * n) / fs, value);
        }), kind);
      shapes += curve("noise", "bound dashed") + curve("bias", "published dashed") + curve("both", "ours thick");
      for (const error of numbers.errors) {
        shapes += draw.dot(right.to((1000 * length) / fs, Math.abs(error)), 2, "ours filled pale");
      }
      shapes += draw.dot(right.to((1000 * length) / fs, numbers.rms), 6, "truth filled");
      if (numbers.best !== null) {
        const low = right.x(Math.min(Math.max(1000 * numbers.best, 1000 * from), 1000 * to));
        shapes += draw.path([[low, right.bottom - 2], [low - 6, right.bottom - 14], [low + 6, right.bottom - 14]], "sensor-3 filled", true);
      }
      const key = [["bound dashed", "noise"], ["published dashed", "motion"], ["ours thick", "both"]];
      key.forEach(([kind, words], i) => {
        shapes += draw.line([x + 84 * i, y - 43], [x + 84 * i + 24, y - 43], kind) + draw.text([x + 84 * i + 29, y - 38], words);
      });
      return {
        height: Math.round((wide ? left.bottom : right.bottom) + 44), shapes,
        handles: [{
          name: "length", label: "Length of the window", at: right.to((1000 * length) / fs, numbers.rms), now: length,
          text: `${draw.number((1000 * length) / fs, 1)} ms`,
          move(px) {
            const now = right.x((1000 * length) / fs);
            const far = lengths.map((n) => Math.abs(right.x((1000 * n) / fs) - px));
            const near = far.indexOf(Math.min(...far));
            // An arrow key asks for the next one, however far that is.
            const place = near === state.place && Math.abs(px - now) >= 3 ? near + Math.sign(px - now) : near;
            return { place: Math.min(Math.max(place, 0), lengths.length - 1) };
          },
        }],
      };
    },
    say({ fs }, { tag }, { length, rms, bound, bias, outliers, best: ideal }) {
      const T = draw.number((1000 * length) / fs, 1);
      const lost = outliers ? ` Of them, ${outliers} are off by more than a bin.` : "";
      const wish = ideal === null ? "the longest is the best" : `the best would have ${draw.brief(1000 * ideal)} ms`;
      return `A window of ${T} ms: ${DRAWS} errors have an RMS of ${draw.brief(rms)} Hz.${lost} Noise alone allows ` +
        `${draw.brief(bound)} Hz, and the time stamp at the ${tag} adds ${draw.brief(bias)} Hz; ${wish}.`;
    },
  };
})();
