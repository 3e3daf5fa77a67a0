// The kitchen in three dimensions: it shows a state, and tells what the visitor chooses in it.

const HELD_HIGHER = 0.2; // m: the dish in hand is seen above the spot where it was picked
const CARRIED_HIGHER = 0.12; // m: a dish's way from hand to rack passes above the counter's edge
const PILE = { turn: 2.4, reach: 0.15, higher: 0.03 }; // as the renderer piles dishes in the sink
const CLICK = 6; // pixels that a pointer may move in a click; more is an orbit
const CANVAS_IN_WORDS =
  "The kitchen in three dimensions, for the pointer. With the keyboard, use the drawing.";

class Kitchen3D {
  /** Whether this browser draws in three dimensions. */
  static available() {
    try {
      const context = document.createElement("canvas").getContext("webgl2");
      context?.getExtension("WEBGL_lose_context")?.loseContext();
      return context !== null;
    } catch {
      return false;
    }
  }

  constructor(element, glb, layout, { onChoose, describe }) {
    Object.assign(this, { element, onChoose, describe, session: null, dishes: [], placements: [] });
    element.classList.add("kitchen-3d");
    this.motions = new Motions3D();
    this.stage = new Stage3D(element, (time) => this.motions.advance(time));
    this.stage.canvas.setAttribute("aria-label", CANVAS_IN_WORDS);
    this.ready = readKitchen3D(glb).then((model) => this.furnish(model, layout));
  }

  furnish(model, layout) {
    if (this.disposed) return;
    this.model = model;
    this.layout = layout;
    this.stage.scene.add(model.kitchen);
    this.picking = new Picking3D(this.stage, model, layout);
    this.hints = new Hints3D(this.stage, model);
    this.listen();
    if (this.shown) this.show(...this.shown);
  }

  /** Show a state of a session; another session is laid anew without a movement. */
  show(state, session, { held = state.held, free = [], blocked = [] } = {}) {
    this.shown = [state, session, { held, free, blocked }];
    if (!this.model) return; // `furnish` comes back to it
    const anew = this.session !== session;
    Object.assign(this, { state, held, session });
    this.placements = [
      ...free.map((instance) => this.placement(instance, false)),
      ...blocked.map((instance) => this.placement(instance, true)),
    ];
    if (anew) this.layDishes();
    this.moveFurniture(anew);
    this.moveDishes(anew);
    this.hints.clear();
    this.hints.mark(this.placements, state.out);
    this.stage.redraw(true);
  }

  dispose() {
    this.disposed = true;
    this.listening?.abort();
    this.stage.dispose();
    this.element.replaceChildren();
    this.element.classList.remove("kitchen-3d");
  }

  placement(instance, blocked) {
    const number = instance - FIRST_PLACEMENT[this.state.out];
    return { instance, blocked, pose: this.model.placements[number] };
  }

  layDishes() {
    this.dishes.forEach((dish) => dish.removeFromParent());
    this.dishes = this.state.dishes.map(({ category }, number) => {
      const dish = newDish3D(this.model.dishes[category], number);
      dish.visible = false;
      return dish;
    });
  }

  moveFurniture(anew) {
    const { door, racks } = this.model;
    const angle = this.state.doorOpen ? door.userData.opened : 0;
    this.send(door, { position: door.position.clone(), quaternion: turned("x", angle) }, anew);
    for (const [rack, node] of Object.entries(racks)) {
      const position = node.position.clone();
      node.userData.closed ??= node.position.y;
      position.y = node.userData.closed - (this.state.out === rack ? node.userData.travel : 0);
      this.send(node, { position, quaternion: node.quaternion.clone() }, anew);
    }
  }

  moveDishes(anew) {
    let sunk = 0;
    this.dishes.forEach((dish, i) => {
      const place = this.state.places[i];
      const arrives = !dish.visible;
      dish.visible = place !== "to arrive";
      if (!dish.visible) return;
      const parent = this.model.racks[place] ?? this.model.kitchen;
      const carried = dish.parent !== null && (dish.parent !== parent || place === "sink");
      if (dish.parent === null) parent.add(dish);
      else parent.attach(dish); // it stays where it is seen and moves from there
      const pose = place === "sink" ? this.inSink(sunk) : this.poseOf(i);
      if (place === "sink") sunk += 1;
      this.send(dish, pose, anew || arrives, carried ? CARRIED_HIGHER : 0);
    });
  }

  send(object, pose, atOnce, lift = 0) {
    if (atOnce || movesLess()) this.motions.put(object, pose);
    else if (!isAt(object, pose)) this.motions.move(object, pose, lift);
  }

  /** A dish's pose in a rack, on the counter or in hand. */
  poseOf(i) {
    const { category, x, y, angle } = this.state.dishes[i];
    if (this.state.places[i] !== "counter") return this.model.placements[this.state.placements[i]];
    const stands = -this.model.dishes[category].geometry.boundingBox.min.z;
    const height = this.model.counter + stands + (this.held === i ? HELD_HIGHER : 0);
    const position = new THREE.Vector3(x / 1000, y / 1000, height);
    return { position, quaternion: turned("z", (angle * Math.PI) / 180) };
  }

  inSink(below) {
    const [, [width, depth]] = this.layout.sink;
    const reach = below > 0 ? PILE.reach / 1000 : 0;
    const spread = new THREE.Vector3(
      reach * width * Math.cos(PILE.turn * below),
      reach * depth * Math.sin(PILE.turn * below),
      PILE.higher * below,
    );
    return { position: spread.add(this.model.sink), quaternion: new THREE.Quaternion() };
  }

  listen() {
    this.listening = new AbortController();
    const { canvas } = this.stage;
    const on = (name, listener) =>
      canvas.addEventListener(name, listener, { signal: this.listening.signal });
    let pressed = null;
    on("pointerdown", (event) => {
      pressed = event.isPrimary ? pointOf(event) : null;
    });
    on("pointermove", (event) => event.buttons === 0 && this.hover(pointOf(event)));
    on("pointerleave", () => this.hover(null));
    on("pointercancel", () => { pressed = null; });
    on("pointerup", (event) => {
      const point = pointOf(event);
      const clicked = pressed && Math.hypot(point.x - pressed.x, point.y - pressed.y) < CLICK;
      pressed = null;
      if (clicked && event.button === 0) this.choose(point);
    });
  }

  choose(point) {
    const instance = this.state ? this.picking.at(point, this) : null;
    if (instance !== null) this.onChoose(instance);
  }

  /** Show what is under the pointer: a ghost at a place, a glow on anything else. */
  hover(point) {
    this.hints.clear();
    const instance = point && this.state ? this.picking.at(point, this) : null;
    this.stage.canvas.style.cursor = instance === null ? "grab" : "pointer";
    if (instance !== null) {
      this.hint(instance);
      this.hints.tell(this.describe(instance), point);
    }
    this.stage.redraw();
  }

  hint(instance) {
    const { door, racks, kitchen, dishes: templates } = this.model;
    const template = this.held === null ? null : templates[this.state.dishes[this.held].category];
    const placement = this.placements.find((one) => one.instance === instance);
    if (placement) this.hints.haunt(template, racks[this.state.out], placement.pose, placement.blocked);
    else if (instance === SINK) this.hints.haunt(template, kitchen, this.inSink(0), false);
    else if (instance === DOOR) this.hints.glow(door);
    else this.hints.glow(racks[RACK_OF[instance]] ?? this.dishes[instance - FIRST_DISH]);
  }
}

const pointOf = ({ offsetX, offsetY }) => ({ x: offsetX, y: offsetY });

function turned(axis, angle) {
  const [x, z] = axis === "x" ? [1, 0] : [0, 1];
  return new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(x, 0, z), angle);
}

const isAt = (object, { position, quaternion }) =>
  object.position.distanceTo(position) < 1e-4 && object.quaternion.angleTo(quaternion) < 1e-3;
