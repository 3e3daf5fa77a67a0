// The kitchen from above, in centimetres; the racks are drawn larger, beneath the counter.

const CENTIMETRE = 10; // millimetres
const [[COUNTER_LEFT, COUNTER_RIGHT], [COUNTER_FRONT, COUNTER_BACK]] = data.layout.counter;
const WIDTH = (COUNTER_RIGHT - COUNTER_LEFT) / CENTIMETRE;
const DEPTH = (COUNTER_BACK - COUNTER_FRONT) / CENTIMETRE;
const ZOOM = 2.4;
const RACK = data.layout.rack.map((length) => (length / CENTIMETRE) * ZOOM);
const RACK_TOP = DEPTH + 26;
const GAP = (WIDTH - 2 * RACK[0]) / 3;
const RACK_LEFT = { top: GAP, bottom: 2 * GAP + RACK[0] };
const DOOR_TOP = RACK_TOP + RACK[1] + 10;
const HEIGHT = DOOR_TOP + 18;
const SUNK_ROW = 4; // dishes side by side in the sink
const SUNK_ZOOM = 0.5;

const counterX = (x) => (x - COUNTER_LEFT) / CENTIMETRE;
const counterY = (y) => (COUNTER_BACK - y) / CENTIMETRE;

/** A dish of a category around the origin, by its half axes. */
function dishShape(category, a, b) {
  const name = data.layout.categories[category];
  if (name === "tray") {
    return [svg("rect", { x: -a, y: -b, width: 2 * a, height: 2 * b, rx: 1 }),
      svg("rect", { class: "inner", x: -a + 1.6, y: -b + 1.6, rx: 1,
        width: Math.max(2 * a - 3.2, 0.5), height: Math.max(2 * b - 3.2, 0.5) })];
  }
  const body = name === "cup" ? Math.min(a, b * 1.1) : a;
  const shift = body - a;
  const inner = name.endsWith("plate") ? 0.62 : 0.76;
  const handle = { class: "handle", cx: body + shift, cy: 0, rx: a - body, ry: b * 0.45 };
  return [...(name === "cup" ? [svg("ellipse", handle)] : []),
    svg("ellipse", { cx: shift, cy: 0, rx: body, ry: b }),
    svg("ellipse", { class: "inner", cx: shift, cy: 0, rx: body * inner, ry: b * inner })];
}

/** Of an upright dish. */
function halfAxes(category) {
  return data.layout.extents[category].map((extent) => extent / 2 / CENTIMETRE);
}

/** Where a dish is drawn: x, y, half axes, angle and zoom. */
function spotOf(state, i, sunk) {
  const dish = state.dishes[i];
  const [width, depth] = halfAxes(dish.category);
  const place = state.places[i];
  if (place === "counter") return [counterX(dish.x), counterY(dish.y), width, depth, dish.angle, 1];
  if (place === "sink") {
    const [[x, y], [wide, deep]] = data.layout.sink;
    const cell = [wide / CENTIMETRE / SUNK_ROW, deep / CENTIMETRE / 3];
    const left = counterX(x - wide / 2) + (sunk % SUNK_ROW + 0.5) * cell[0];
    const top = counterY(y + deep / 2) + (Math.floor(sunk / SUNK_ROW) % 3 + 0.5) * cell[1];
    return [left, top, width, depth, 0, SUNK_ZOOM];
  }
  return spotInRack(place, state.placements[i]);
}

/** Where a dish at a placement is drawn: x, y, half axes, angle and zoom. */
function spotInRack(rack, placement) {
  const [, x, y, a, b, angle] = data.layout.placements[placement];
  return [RACK_LEFT[rack] + RACK[0] / 2 + (x / CENTIMETRE) * ZOOM,
    RACK_TOP + RACK[1] / 2 - (y / CENTIMETRE) * ZOOM, a / CENTIMETRE, b / CENTIMETRE, angle, ZOOM];
}

function drawDish(state, i, sunk) {
  const [x, y, a, b, angle, zoom] = spotOf(state, i, sunk);
  const { category } = state.dishes[i];
  const name = data.layout.categories[category];
  const marks = `${state.held === i ? " held" : ""}${state.moved === i ? " moved" : ""}`;
  return svg("g", {
    class: `dish d${category}${marks}`,
    "data-instance": FIRST_DISH + i,
    "data-place": state.places[i],
    transform: `translate(${x.toFixed(1)},${y.toFixed(1)}) rotate(${-angle}) scale(${zoom})`,
  },
  svg("title", {}, state.held === i ? `${name}, in hand` : name),
  ...dishShape(category, a, b));
}

function drawRack(state, rack, dishes) {
  const out = state.out === rack;
  const left = RACK_LEFT[rack];
  const wires = [];
  for (let i = 1; i < 6; i += 1) {
    wires.push(`M${left + (i * RACK[0]) / 6},${RACK_TOP}v${RACK[1]}`,
      `M${left},${RACK_TOP + (i * RACK[1]) / 6}h${RACK[0]}`);
  }
  const instance = rack === "top" ? TOP_RACK : BOTTOM_RACK;
  return svg("g", { class: out ? "rack out" : "rack", "data-instance": instance },
    label(left + RACK[0] / 2, RACK_TOP - 7, `${rack} rack, ${out ? "out" : "in"}`, "middle"),
    svg("rect", { class: "frame", x: left, y: RACK_TOP, width: RACK[0], height: RACK[1], rx: 4 }),
    svg("path", { class: "wires", d: wires.join("") }), ...dishes);
}

function drawCounter() {
  const [[x, y], [wide, deep]] = data.layout.sink;
  const sink = { x: counterX(x - wide / 2), y: counterY(y + deep / 2),
    width: wide / CENTIMETRE, height: deep / CENTIMETRE, rx: 5 };
  return svg("g", {},
    svg("rect", { class: "counter", x: 0, y: 0, width: WIDTH, height: DEPTH, rx: 3 }),
    svg("rect", { class: "basin", "data-instance": SINK, ...sink }),
    svg("path", { class: "tap", d: `M${counterX(x)},4v16` }));
}

function drawDoor(state) {
  const title = state.doorOpen ? "door open" : "door closed";
  return svg("g", { class: state.doorOpen ? "door open" : "door", "data-instance": DOOR },
    svg("rect", { x: GAP, y: DOOR_TOP, width: WIDTH - 2 * GAP, height: 16, rx: 4 }),
    label(WIDTH / 2, DOOR_TOP + 12, title, "middle"));
}

/** One state of the kitchen. */
function drawKitchen(state, title) {
  const drawn = { counter: [], sink: [], top: [], bottom: [] };
  state.places.forEach((place, i) => {
    const of = drawn[place];
    if (of) of.push(drawDish(state, i, of.length));
  });
  const viewBox = `-3 -3 ${WIDTH + 6} ${HEIGHT + 6}`;
  return svg("svg", { viewBox, role: "img", "aria-label": title },
    drawDoor(state), drawRack(state, "top", drawn.top), drawRack(state, "bottom", drawn.bottom),
    drawCounter(), ...drawn.sink, ...drawn.counter);
}

/** All decisions as a timeline, the later ones fainter. */
function drawTimeline(steps, now, length) {
  const cells = steps.slice(1).map(({ kind, refused }, i) => svg("rect", {
    x: i + 0.06, y: refused ? 0 : 2, width: 0.88, height: refused ? 10 : 8,
    class: `${refused ? "refused" : kind}${i >= now ? " ahead" : ""}`,
  }));
  const viewBox = `0 0 ${length} 10`;
  return svg("svg", { viewBox, preserveAspectRatio: "none", "aria-hidden": "true" }, ...cells);
}

function dishLegend() {
  return data.layout.categories.map((name, category) => {
    const shape = dishShape(category, ...halfAxes(category));
    const swatch = { viewBox: "-14 -14 28 28", class: "swatch large", "aria-hidden": "true" };
    const dish = svg("g", { class: `dish d${category}` }, ...shape);
    return html("li", {}, svg("svg", swatch, dish), name);
  });
}
