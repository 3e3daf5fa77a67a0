// What a ray from the eye through the pointer meets, as the number of an instance.

const NEAR_PLACEMENT = 0.075; // m between the ray and the middle of a dish at its placement
const BLOCKED_IS_FARTHER = 0.02; // m: of two near placements a free one is meant
const NEAR_DISH = 18; // pixels: a dish seen from afar is smaller than a fingertip
const RACK_HEIGHT = 0.12; // m: a rack is more air than wire, so a box stands for it

class Picking3D {
  constructor(stage, model, layout) {
    this.stage = stage;
    this.model = model;
    this.ray = new THREE.Raycaster();
    const [[x, y], [width, depth]] = layout.sink.map(inMetres);
    this.sink = unseenBox(model.kitchen, width, depth, 0.18);
    this.sink.position.set(x, y, model.counter - 0.085);
    this.racks = Object.entries(model.racks).map(([rack, node]) => {
      const box = unseenBox(node, ...inMetres(layout.rack), RACK_HEIGHT);
      box.position.z = RACK_HEIGHT / 2;
      return [box, RACK_NUMBER[rack]];
    });
  }

  /** The instance at a point of the canvas, or null. `view` is what Kitchen3D shows. */
  at(point, view) {
    const { width, height, camera, scene } = this.stage;
    scene.updateMatrixWorld(); // what has moved may not be drawn yet
    camera.updateMatrixWorld();
    const onCanvas = new THREE.Vector2((2 * point.x) / width - 1, 1 - (2 * point.y) / height);
    this.ray.setFromCamera(onCanvas, camera);
    return this.placementAt(view) ?? this.bodyAt(view) ?? this.dishNear(point, view);
  }

  placementAt({ placements, state }) {
    let nearest = { distance: NEAR_PLACEMENT, instance: null };
    for (const { instance, pose, blocked } of placements) {
      const middle = this.model.racks[state.out].localToWorld(pose.position.clone());
      const distance = this.ray.ray.distanceToPoint(middle) + (blocked ? BLOCKED_IS_FARTHER : 0);
      if (distance < nearest.distance) nearest = { distance, instance };
    }
    return nearest.instance;
  }

  /** The first thing on the ray: the furniture hides what is behind it. */
  bodyAt({ state, held, dishes }) {
    const bodies = new Map([[this.model.room, null], [this.model.door, DOOR], ...this.racks]);
    if (held !== null) bodies.set(this.sink, SINK);
    dishes.forEach((dish, i) => {
      const place = state.places[i];
      if (place === "counter" && i !== held) bodies.set(dish, FIRST_DISH + i);
      if (place in RACK_NUMBER) bodies.set(dish, RACK_NUMBER[place]); // it moves with its rack
    });
    const [hit] = this.ray.intersectObjects([...bodies.keys()]);
    let object = hit?.object ?? null;
    while (object && !bodies.has(object)) object = object.parent;
    return bodies.get(object) ?? null;
  }

  /** The dish on the counter whose middle is near the point on the canvas. */
  dishNear(point, { state, held, dishes }) {
    if (held !== null) return null;
    const { width, height, camera } = this.stage;
    let nearest = { distance: NEAR_DISH, instance: null };
    dishes.forEach((dish, i) => {
      if (state.places[i] !== "counter") return;
      const { x, y } = dish.getWorldPosition(new THREE.Vector3()).project(camera);
      const distance = Math.hypot(((x + 1) * width) / 2 - point.x, ((1 - y) * height) / 2 - point.y);
      if (distance < nearest.distance) nearest = { distance, instance: FIRST_DISH + i };
    });
    return nearest.instance;
  }
}

const RACK_NUMBER = Object.fromEntries(
  Object.entries(RACK_OF).map(([instance, rack]) => [rack, Number(instance)]),
);

const inMetres = (lengths) => lengths.map((length) => length / 1000);

function unseenBox(parent, ...size) {
  const box = new THREE.Mesh(new THREE.BoxGeometry(...size), new THREE.MeshBasicMaterial());
  box.visible = false; // a ray meets it all the same
  parent.add(box);
  return box;
}
