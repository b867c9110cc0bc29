// The decision to stop: what a threshold, a rule and a tracker cost on saved courses.
"use strict";

explorables.stop = (() => {
  const FLOOR = 0.05; // % of the courses; none stands there, too
  const RATES = { from: FLOOR, to: 100, log: true, ticks: [0.1, 1, 10, 100], label: "% of the courses" };
  const LEADS = { from: 0, to: 1, ticks: [0, 0.2, 0.4, 0.6, 0.8, 1], label: "lead (s)" };
  // A row of the saved table: percentages with their intervals, median, collisions by lead.
  function row(saved) {
    const filled = ([first, ...counts]) => [...Array(first).fill(0), ...counts];
    const [inTime, late] = saved.slice(7).map(filled);
    return { missed: saved.slice(0, 3), false: saved.slice(3, 6), median: saved[6], inTime, late };
  }
  const sum = (counts) => counts.reduce((total, count) => total + count, 0);

  return {
    start: ({ thresholds }) => ({ tracker: "paper", rule: "within 0.3 s", place: thresholds.indexOf(0.5) }),
    controls: ({ thresholds, labels, table }) => [
      {
        name: "place", label: "threshold", min: 0, max: thresholds.length - 1, step: 1,
        text: (v) => `${thresholds[v]}`,
      },
      { kind: "choice", name: "tracker", label: "tracker", options: Object.entries(labels) },
      {
        kind: "choice", name: "rule", label: "collision",
        options: Object.keys(table.bank).map((rule) => [rule, rule]),
      },
    ],
    measure(settings, state) {
      const { thresholds, table, counts } = settings;
      const found = row(table[state.tracker][state.rule][state.place]);
      const never = counts.collision - sum(found.inTime) - sum(found.late);
      return { threshold: thresholds[state.place], ...found, never };
    },
    draw(settings, state, numbers, width) {
      const { thresholds, table, counts, bin } = settings;
      const wide = width >= 600, half = wide ? width / 2 - 14 : width;
      const rows = table[state.tracker][state.rule].map(row);
      const scale = { from: 0, to: thresholds.length - 1 };
      const left = draw.panel({ x: 44, y: 74, width: half - 60, height: 180 }, { ...scale, label: "threshold" }, RATES);
      let shapes = left.frame() + draw.text([38, left.bottom + 4.5], "0", "end");
      [0, 2, 5, 8, 10].forEach((i) => (shapes += draw.text([left.x(i), left.bottom + 18], thresholds[i], "middle")));
      const at = (i, share) => left.to(i, share);
      for (const [key, kind] of [["missed", "published"], ["false", "ours"]]) {
        const low = rows.map((row, i) => at(i, row[key][1])), high = rows.map((row, i) => at(i, row[key][2]));
        shapes += draw.path([...high, ...low.reverse()], `${kind} filled pale`, true);
        shapes += draw.path(rows.map((row, i) => at(i, row[key][0])), kind);
        rows.forEach((row, i) => {
          shapes += draw.dot(at(i, row[key][0]), i === state.place ? 6 : 3, `${kind} filled`);
        });
      }
      shapes += draw.line([left.x(state.place), left.top], [left.x(state.place), left.bottom], "truth dashed");
      shapes += draw.box(44, 5, 12, 12, "published filled") + draw.text([62, 16], "not in time before a collision");
      shapes += draw.box(44, 24, 12, 12, "ours filled") + draw.text([62, 35], "stops, though it passes");

      const x = wide ? half + 62 : 44, y = wide ? left.top : left.bottom + 118;
      const most = counts.collision, highest = (100 * Math.max(...numbers.inTime, ...numbers.late)) / most;
      const top = [10, 20, 50].find((limit) => highest <= limit) ?? 100;
      const right = draw.panel(
        { x, y, width: width - x - 8, height: 180 }, LEADS,
        { from: 0, to: top, ticks: [0, top / 2, top], label: "% of the collisions" });
      shapes += right.frame();
      const thick = right.x(bin) - right.x(0);
      const stack = (lead, low, count, kind) => {
        const up = right.to(0, (100 * (low + count)) / most)[1], down = right.to(0, (100 * low) / most)[1];
        return count ? draw.box(right.x(lead) + 0.5, up, thick - 1, Math.max(down - up, 1), kind) : "";
      };
      const lateAt = (i) => numbers.late[i] ?? 0;
      numbers.inTime.forEach((count, i) => {
        shapes += stack(i * bin, lateAt(i), count, "ours filled");
      });
      numbers.late.forEach((count, i) => (shapes += stack(i * bin, 0, count, "published filled")));
      if (numbers.median !== null) {
        const middle = right.to(numbers.median, 0)[0];
        shapes += draw.line([middle, right.top], [middle, right.bottom], "truth dashed");
        shapes += draw.text([Math.min(middle + 5, right.right - 50), right.top + 12], "median");
      }
      const head = y - 58;
      shapes += draw.text([x, head], `too late ${sum(numbers.late)}, never ${numbers.never},`);
      shapes += draw.text([x, head + 19], `in time ${sum(numbers.inTime)} of ${most} collisions`);
      return {
        height: Math.round((wide ? left.bottom : right.bottom) + 44), shapes,
        handles: [{
          name: "threshold", label: "Threshold", at: [left.x(state.place), left.top - 2], now: numbers.threshold,
          text: `${numbers.threshold}`,
          move(px) {
            const near = Math.round(((px - left.left) / (left.right - left.left)) * scale.to);
            const step = Math.sign(px - left.x(state.place)) * (Math.abs(px - left.x(state.place)) > 3 ? 1 : 0);
            const place = near === state.place && Math.abs(px - left.x(state.place)) < 5 ? state.place + step : near;
            return { place: Math.min(Math.max(place, 0), scale.to) };
          },
        }],
      };
    },
    say({ labels, counts }, { tracker, rule }, { threshold, missed, false: needless, median }) {
      const { collision, passing } = counts;
      const lead = median === null ? "For half of them it never decides" : `The median lead is ${draw.number(median, 3)} s`;
      return `${labels[tracker]}, collision ${rule}, threshold ${threshold}: not in time before ${draw.number(missed[0], 1)} % ` +
        `of ${collision} collisions, and stops for ${draw.number(needless[0], 1)} % of ${passing} ` +
        `that pass. ${lead}.`;
    },
  };
})();
