// A page that shows the kitchen in three dimensions, as the project's own page does.

const session = data.session;
const chosen = [];
let state = kitchenAtStart(session);
const view = new Kitchen3D(byId("kitchen"), bytesOf(data.glb).buffer, data.layout, {
  onChoose(instance) {
    chosen.push(instance);
    byId("said").textContent = decide(state, instance);
    show();
  },
  describe: (instance) => `instance ${instance}`,
});
function show() {
  const places = placementsInHand(state);
  const number = (k) => FIRST_PLACEMENT[state.out] + k;
  view.show(state, session, {
    free: places.filter((k) => !isBlocked(state, state.out, k)).map(number),
    blocked: places.filter((k) => isBlocked(state, state.out, k)).map(number),
  });
}
/** Another visit: a new kitchen after some decisions. */
function begin(decisions) {
  state = kitchenAtStart(session);
  chosen.length = 0;
  decisions.forEach((instance) => decide(state, instance));
  view.session = null;
  view.stage.look();
  show();
}
const frame = () => new Promise(requestAnimationFrame);
async function drawn() {
  do await frame(); while (view.stage.frame !== null);
}
/** Where a point of an object's own frame is on the screen. */
function onScreen(object, ...point) {
  view.stage.scene.updateMatrixWorld();
  view.stage.camera.updateMatrixWorld();
  const { x, y } = object.localToWorld(new THREE.Vector3(...point)).project(view.stage.camera);
  const { left, top, width, height } = view.stage.canvas.getBoundingClientRect();
  return [left + ((x + 1) * width) / 2, top + ((1 - y) * height) / 2];
}
show();
