// The same two kitchens in three dimensions, where the browser draws them.

const three = { on: false, glb: null, views: {} };

const chooseNothing = () => {}; // TTP's kitchen is only looked at

function startThree() {
  if (!data.glb || !Kitchen3D.available()) return;
  three.glb = bytesOf(data.glb).buffer;
  byId("three").hidden = false;
  byId("three").addEventListener("click", toggleThree);
}

function toggleThree() {
  three.on = !three.on;
  byId("three").setAttribute("aria-pressed", three.on);
  for (const side of ["you", "ttp"]) {
    byId(`${side}-drawing`).hidden = three.on;
    byId(`${side}-3d`).hidden = !three.on;
  }
  showInThree("you", yourState(), you.kitchen);
  if (!study.name) showInThree("ttp", ttpState(), ttp.kitchen);
}

function showInThree(side, state, session) {
  if (!three.on) return;
  const own = side === "you";
  three.views[side] ??= new Kitchen3D(byId(`${side}-3d`), three.glb, data.layout, {
    onChoose: own ? youChoose : chooseNothing,
    describe: (instance) => (own ? nameOf(yourState(), instance) : nameOf(ttpState(), instance)),
  });
  const [free, blocked] = [false, true].map((taken) => placementsInHand(state)
    .filter((placement) => isBlocked(state, state.out, placement) === taken)
    .map((placement) => FIRST_PLACEMENT[state.out] + placement));
  three.views[side].show(state, session, { held: state.held, free: own ? free : [],
    blocked: own ? blocked : [] });
}
