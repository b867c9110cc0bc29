// All combinations of four causes: NEES and NIS of each, as a study of the library has saved them.
"use strict";

explorables.combinations = (() => {
  const SCALE = { from: 1, to: 1000, log: true, ticks: [1, 10, 100, 1000] };
  const LABELS = { published: "0.1 I", matched: "matched", shared: "shared", per_axis: "per axis", fixed: "fixed", drawn: "drawn" };

  const chosen = (switches, state) => Object.entries(switches).map(([name, values]) => values[state[name] ? 1 : 0]);
  const median = ([value]) => value;

  return {
    start: ({ moments }) => ({ P0: false, noise: false, start: false, world: false, place: moments.indexOf(100) }),
    controls: ({ moments }) => [
      { kind: "switch", name: "P0", label: "P0 of the size of the error" },
      { kind: "switch", name: "noise", label: "process noise on each axis" },
      { kind: "switch", name: "start", label: "start drawn in each run" },
      { kind: "switch", name: "world", label: "no curvature" },
      { kind: "play", name: "place", label: "time", min: 0, max: moments.length - 1, step: 1, text: (v) => `${moments[v] + 1} samples` },
    ],
    measure({ switches, rows }, state) {
      const key = chosen(switches, state), row = rows[key.join()];
      return { key, nees: row.nees[state.place], nis: row.nis[state.place] };
    },
    draw({ switches, rows, moments, middle }, state, numbers, width) {
      const wide = width >= 600, names = 182, half = wide ? Math.round(0.54 * width) : width;
      const key = numbers.key.join(), { place } = state;
      const [curved, straight] = switches.world;
      const filters = [...new Set(Object.keys(rows).map((name) => name.slice(0, name.lastIndexOf(","))))];
      const left = draw.panel(
        { x: names, y: 54, width: half - names - 20, height: 26 * filters.length }, { ...SCALE, label: "median NEES" }, { from: 0, to: filters.length });
      let shapes = draw.text([0, 14], "P0, noise, start") + draw.dot([128, 9], 6, "published filled");
      shapes += draw.text([140, 14], "curved") + draw.box(204, 3, 12, 12, "ours filled") + draw.text([222, 14], "straight");
      shapes += left.frame();
      const right = left.to(middle, 0)[0];
      shapes += draw.line([right, left.top - 8], [right, left.bottom], "bound dashed") + draw.text([right, left.top - 13], "right: 5.3", "middle");
      filters.forEach((name, i) => {
        const y = left.top + 26 * i + 13, words = name.split(",").map((word) => LABELS[word]).join(", ");
        const own = key.startsWith(`${name},`);
        shapes += draw.line([left.left, y], [left.right, y], "grid");
        shapes += draw.text([0, y + 5], words, "start", own ? "bold" : undefined);
        for (const [world, mark] of [[curved, (at, size) => draw.dot(at, size, "published filled")],
          [straight, (at, size) => draw.box(at[0] - size, at[1] - size, 2 * size, 2 * size, "ours filled")]]) {
          const one = `${name},${world}`, at = [left.to(median(rows[one].nees[place]), 0)[0], y];
          shapes += mark(at, one === key ? 8 : 4);
          if (one === key) shapes += draw.box(at[0] - 12, at[1] - 12, 24, 24, "truth");
        }
      });

      // The course of the chosen one, over all others.
      const x = wide ? half + 44 : 44, y = wide ? left.top : left.bottom + 106;
      const panel = draw.panel(
        { x, y, width: width - x - 20, height: 26 * filters.length },
        { from: 1, to: 1000, log: true, ticks: [1, 10, 100, 1000], label: "samples" }, SCALE);
      shapes += panel.frame();
      const to = (k, value) => panel.to(moments[k] + 1, value);
      const course = (row, kind, name) => draw.path(row[name].map((one, k) => to(k, median(one))), kind);
      for (const row of Object.values(rows)) shapes += course(row, "bound thin", "nees");
      const row = rows[key], kind = numbers.key.at(-1) === curved ? "published" : "ours";
      const ends = [1, 2].map((end) => row.nees.map((one, k) => to(k, one[end])));
      shapes += draw.path([...ends[0], ...ends[1].reverse()], `${kind} filled pale`, true);
      shapes += course(row, `${kind} thick`, "nees") + course(row, "truth dashed", "nis");
      shapes += draw.line([x, y - 44], [x + 26, y - 44], `${kind} thick`) + draw.text([x + 32, y - 39], "NEES");
      shapes += draw.line([x + 92, y - 44], [x + 118, y - 44], "truth dashed") + draw.text([x + 124, y - 39], "NIS");
      shapes += draw.line(panel.to(1, middle), panel.to(1000, middle), "bound dashed");
      const now = to(place, 1);
      shapes += draw.line([now[0], panel.top], now, "axis");
      return { height: Math.round(panel.bottom + 44), shapes };
    },
    say({ runs, middle, moments }, state, { key, nees, nis }) {
      const [P0, noise, start, world] = key, brief = (v) => draw.number(Number(v.toPrecision(3)));
      const all = key.every((value) => ["published", "shared", "fixed", "curved"].includes(value));
      const interval = ([value, low, high]) => `${brief(value)} (${brief(low)} to ${brief(high)})`;
      return `P0 ${LABELS[P0]}, process noise ${LABELS[noise]}, start ${LABELS[start]}, ${world} world${all ? ": all as in the paper" : ""}. ` +
        `After ${moments[state.place] + 1} samples the median NEES of ${runs} runs is ${interval(nees)}, and the median NIS ${interval(nis)}; ` +
        `of a consistent filter both are ${draw.number(middle, 1)}.`;
    },
  };
})();
