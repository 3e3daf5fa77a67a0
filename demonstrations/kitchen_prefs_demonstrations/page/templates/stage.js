// The drawing as something to act on: whatever a decision can choose is a button.

const FINGERTIP = 7; // centimetres around a dish on the counter in which a tap still means it
const ON_THE_MARK = 1.5; // centimetres of the rack's drawing around a blocked place that mean it
const DIRECTIONS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** A drawing in which a visitor decides, by mouse, finger or keyboard. */
class Stage {
  /** `onChoose(instance)` is told every choice, also one that the kitchen refuses. */
  constructor(element, onChoose) {
    this.element = element;
    this.onChoose = onChoose;
    element.addEventListener("click", (event) => this.click(event));
    element.addEventListener("keydown", (event) => this.press(event));
    element.addEventListener("focusin", (event) => this.showGhost(placementAt(event.target)));
    element.addEventListener("pointermove", (event) => this.showGhost(this.placementUnder(event)));
    element.addEventListener("pointerleave", () => this.showGhost(null));
  }

  /** Draw a state. A focus inside stays on its instance, or goes to what can be chosen next. */
  show(state, title) {
    const focused = instanceOf(document.activeElement);
    const within = this.element.contains(document.activeElement);
    this.state = state;
    this.drawing = drawKitchen(state, title);
    this.drawing.setAttribute("role", "group");
    this.drawing.append(...placementsInHand(state).map((one) => drawPlace(state, one)));
    choicesIn(state).forEach((instance) => makeButton(this.find(instance), state, instance));
    this.element.replaceChildren(this.drawing);
    this.ghost = null;
    if (within) this.find(this.canFocus(focused) ? focused : nextChoice(state))?.focus();
  }

  find(instance) {
    return this.drawing.querySelector(`[data-instance="${instance}"]`);
  }

  canFocus(instance) {
    return this.find(instance)?.getAttribute("tabindex") === "0";
  }

  click(event) {
    const placement = placementAt(event.target) ?? this.placementUnder(event);
    const instance = placement ?? this.rackOf(event.target) ?? instanceOf(event.target)
      ?? this.dishNear(event);
    if (instance !== null) this.onChoose(instance);
  }

  /** The rack of a dish that stands in one: with empty hands a click on it means the rack. */
  rackOf(target) {
    const dish = target.closest?.(".dish");
    if (this.state.held !== null || !["top", "bottom"].includes(dish?.dataset.place)) return null;
    return instanceOf(dish.closest(".rack"));
  }

  press(event) {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const instance = instanceOf(event.target);
    if (instance === null) return;
    if (event.key === "Enter" || event.key === " ") {
      if (!event.repeat) this.onChoose(instance); // a key held down is one choice
    }
    else if (event.key in DIRECTIONS) this.moveFocus(event.target, DIRECTIONS[event.key]);
    else return;
    event.preventDefault();
  }

  /** Focus the nearest button within a quarter turn of a direction. */
  moveFocus(from, [dx, dy]) {
    const start = centreOf(from);
    const ahead = [...this.drawing.querySelectorAll("[role=button]")].map((button) => {
      const [x, y] = centreOf(button).map((value, axis) => value - start[axis]);
      const [along, across] = [x * dx + y * dy, Math.abs(x * dy - y * dx)];
      return { button, along, across, distance: along + 2 * across };
    }).filter(({ along, across }) => along > 1 && along >= across);
    ahead.sort((one, other) => one.distance - other.distance);
    ahead[0]?.button.focus();
  }

  /** The placement that a pointer in the rack means while a dish is in hand, else null. */
  placementUnder(event) {
    if (this.state.held === null || this.state.out === null) return null;
    const [x, y] = this.pointOf(event);
    const [left, top] = [RACK_LEFT[this.state.out], RACK_TOP];
    if (x < left || x > left + RACK[0] || y < top || y > top + RACK[1]) return null;
    return nearestPlacement(this.state, x, y);
  }

  /** The dish on the counter that a fingertip means, else null. */
  dishNear(event) {
    if (this.state.held !== null) return null;
    const [x, y] = this.pointOf(event);
    const near = counterDishes(this.state).map((i) => {
      const { x: dishX, y: dishY } = this.state.dishes[i];
      return { i, distance: Math.hypot(counterX(dishX) - x, counterY(dishY) - y) };
    }).filter(({ distance }) => distance < FINGERTIP);
    near.sort((one, other) => one.distance - other.distance);
    return near.length ? FIRST_DISH + near[0].i : null;
  }

  /** Where an event is, in the drawing's centimetres. */
  pointOf(event) {
    const matrix = this.drawing.getScreenCTM().inverse();
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix);
    return [x, y];
  }

  /** The dish in hand as it would stand at a placement; none where that is null or blocked. */
  showGhost(instance) {
    this.ghost?.remove();
    this.ghost = null;
    if (instance === null || this.state.out === null || this.state.held === null) return;
    const placement = instance - FIRST_PLACEMENT[this.state.out];
    if (isBlocked(this.state, this.state.out, placement)) return;
    this.ghost = drawGhost(this.state, placement);
    this.find(this.state.out === "top" ? TOP_RACK : BOTTOM_RACK).append(this.ghost);
  }
}

/** The instance that an element of a drawing stands for, or null. */
function instanceOf(element) {
  const bearer = element?.closest?.("[data-instance]");
  return bearer ? Number(bearer.dataset.instance) : null;
}

function placementAt(element) {
  const instance = instanceOf(element);
  return instance !== null && instance >= FIRST_PLACEMENT.bottom ? instance : null;
}

function centreOf(element) {
  const { x, y, width, height } = element.getBoundingClientRect();
  return [x + width / 2, y + height / 2];
}

/** The free placement nearest to a point; a blocked one where the point is right on it. */
function nearestPlacement(state, x, y) {
  const byDistance = placementsInHand(state).map((placement) => {
    const [spotX, spotY] = spotInRack(state.out, placement);
    const blocked = isBlocked(state, state.out, placement);
    return { placement, blocked, distance: Math.hypot(spotX - x, spotY - y) };
  }).sort((one, other) => one.distance - other.distance);
  const [nearest] = byDistance;
  const free = byDistance.find(({ blocked }) => !blocked);
  const meant = free === undefined || nearest.distance < ON_THE_MARK ? nearest : free;
  return FIRST_PLACEMENT[state.out] + meant.placement;
}

function makeButton(element, state, instance) {
  const blocked = element.classList.contains("blocked");
  fill(element, {
    role: "button", tabindex: blocked ? "-1" : "0", "aria-label": nameOf(state, instance),
    "aria-disabled": blocked && "true",
  }, []);
  element.classList.add("choosable");
}

/** A placement of the category in hand: a dot where it is free, else a cross. */
function drawPlace(state, placement) {
  const [x, y] = spotInRack(state.out, placement);
  const blocked = isBlocked(state, state.out, placement);
  return svg("g", {
    class: blocked ? "place blocked" : "place free",
    "data-instance": FIRST_PLACEMENT[state.out] + placement,
    transform: `translate(${x.toFixed(1)},${y.toFixed(1)})`,
  }, blocked ? svg("path", { d: "M-1.1,-1.1l2.2,2.2M1.1,-1.1l-2.2,2.2" })
    : svg("circle", { r: 1.5 }));
}

function drawGhost(state, placement) {
  const [x, y, a, b, angle, zoom] = spotInRack(state.out, placement);
  const { category } = state.dishes[state.held];
  return svg("g", {
    class: `dish ghost d${category}`,
    transform: `translate(${x.toFixed(1)},${y.toFixed(1)}) rotate(${-angle}) scale(${zoom})`,
  }, ...dishShape(category, a, b));
}
