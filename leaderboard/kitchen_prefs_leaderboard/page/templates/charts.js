const COLOURS = 8;
const SHAPES = ["circle", "square", "diamond", "triangle"];
const PANEL = 340; // width of a chart, in its own units

const PATHS = {
  circle: "M-4,0a4,4 0 1,0 8,0a4,4 0 1,0 -8,0",
  square: "M-3.6,-3.6h7.2v7.2h-7.2z",
  diamond: "M0,-5l5,5l-5,5l-5,-5z",
  triangle: "M0,-4.8l4.8,8.4h-9.6z",
};

/** An entry's mark: colour and shape stay the same whatever else is ticked. */
function mark(index, x, y) {
  const shape = SHAPES[(index + Math.floor(index / COLOURS)) % SHAPES.length];
  return svg("path", {
    d: PATHS[shape], class: `series s${index % COLOURS}`, transform: `translate(${x},${y})`,
  });
}

function bar(index, from, to) {
  return svg("path", { class: `series interval s${index % COLOURS}`, d: `M${from}L${to}` });
}

const nameOf = (index) => data.entries[index].submission.name;
const shorten = (text, most) => (text.length > most ? `${text.slice(0, most - 1)}\u2026` : text);

/** The ticked entries in the table's order. */
const ticked = () => [...shown].sort((a, b) => a - b);

/** The tenth at which the axis begins; it ends at 1, and all intervals are on it. */
function lowest(values) {
  return Math.max(0, Math.floor(10 * Math.min(0.9, ...values)) / 10);
}

function axisTicks(low) {
  const step = low < 0.5 ? 0.2 : 0.1;
  const ticks = [];
  for (let value = 1; value > low - 1e-9; value -= step) ticks.push(value);
  return ticks;
}

function splitPanel(split, rows, low) {
  const [left, right, pitch, top] = [112, PANEL - 46, 20, 8];
  const height = top + rows.length * pitch + 22;
  const x = (value) => left + ((value - low) / (1 - low)) * (right - left);
  const chart = svg("svg", { viewBox: `0 0 ${PANEL} ${height}`, role: "img" });
  const inWords = [];
  for (const tick of axisTicks(low)) {
    chart.append(svg("path", { class: "grid", d: `M${x(tick)},${top}V${height - 20}` }),
      label(x(tick), height - 6, tick.toFixed(1), "middle faint"));
  }
  rows.forEach((index, row) => {
    const [mean, from, to] = data.entries[index].metrics[split].PE;
    const y = top + (row + 0.5) * pitch;
    chart.append(
      svg("g", {}, svg("title", {}, nameOf(index)), label(0, y + 4, shorten(nameOf(index), 17))),
      bar(index, [x(from), y], [x(to), y]),
      mark(index, x(mean), y),
      label(PANEL, y + 4, fixed(mean), "end"),
    );
    inWords.push(`${nameOf(index)} ${fixed(mean)}, ${fixed(from)} to ${fixed(to)}`);
  });
  chart.setAttribute("aria-label", `PE on ${words(split)}: ${inWords.join("; ")}`);
  return panel(words(split), chart);
}

function panel(title, chart) {
  return html("figure", { class: "card panel" }, html("figcaption", {}, title), chart);
}

function countPanel(title, rows, low) {
  const [left, right, top, bottom] = [30, PANEL - 12, 10, 190];
  const counts = data.entries.find(isDrawn).drawn.by_count[title].map(([count]) => count);
  const [fewest, most] = [counts[0], counts.at(-1)];
  const x = (count) => left + 10 + ((count - fewest) / (most - fewest)) * (right - left - 20);
  const y = (value) => bottom - ((value - low) / (1 - low)) * (bottom - top);
  const chart = svg("svg", { viewBox: `0 0 ${PANEL} 228`, role: "img" });
  for (const tick of axisTicks(low)) {
    chart.append(svg("path", { class: "grid", d: `M${left},${y(tick)}H${right}` }),
      label(left - 6, y(tick) + 4, tick.toFixed(1), "end faint"));
  }
  for (const count of counts) chart.append(label(x(count), bottom + 16, count, "middle faint"));
  chart.append(label((left + right) / 2, bottom + 34, "dishes per rack", "middle faint"));
  const inWords = rows.map((index, row) => {
    const shift = (row - (rows.length - 1) / 2) * Math.min(4, 20 / rows.length);
    chart.append(countLine(index, title, (count) => x(count) + shift, y));
    const means = data.entries[index].drawn.by_count[title];
    const each = means.map(([count, mean]) => `${count}: ${fixed(mean)}`);
    return `${nameOf(index)} ${each.join(", ")}`;
  });
  chart.setAttribute("aria-label", `PE by dishes per rack. ${title}. ${inWords.join("; ")}`);
  return panel(title, chart);
}

/** One entry's line, shifted a little so that the bars of all entries can be seen. */
function countLine(index, title, x, y) {
  const points = data.entries[index].drawn.by_count[title];
  const line = points.map(([count, mean]) => `${x(count)},${y(mean)}`).join("L");
  return svg(
    "g",
    {},
    svg("title", {}, nameOf(index)),
    svg("path", { class: `series line s${index % COLOURS}`, d: `M${line}` }),
    ...points.flatMap(([count, mean, from, to]) => [
      bar(index, [x(count), y(from)], [x(count), y(to)]),
      mark(index, x(count), y(mean)),
    ]),
  );
}

function chartLegend(rows) {
  return rows.map((index) => {
    const swatch = svg("svg", { viewBox: "-7 -7 14 14", class: "swatch", "aria-hidden": "true" },
      mark(index, 0, 0));
    const { name, track } = data.entries[index].submission;
    return html("li", {}, swatch, name, html("span", { class: "meaning" }, track));
  });
}

function drawCharts() {
  const rows = ticked();
  const none = () => html("p", {}, "No row is ticked.");
  const entries = rows.map((index) => data.entries[index]);
  const ofSplits = entries.flatMap(({ metrics }) => SPLITS.map((split) => metrics[split].PE));
  const splitLow = lowest(ofSplits.map(([, low]) => low));
  const points = entries.flatMap(({ drawn }) => Object.values(drawn.by_count).flat());
  const countLow = lowest(points.map(([, , low]) => low));
  const titles = Object.keys(data.entries.find(isDrawn).drawn.by_count);
  byId("chart-legend").replaceChildren(...chartLegend(rows));
  byId("by-split").replaceChildren(
    ...(rows.length ? SPLITS.map((split) => splitPanel(split, rows, splitLow)) : [none()]));
  byId("by-count").replaceChildren(
    ...(rows.length ? titles.map((title) => countPanel(title, rows, countLow)) : [none()]));
}
