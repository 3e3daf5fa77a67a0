// The kitchen's rules as far as a drawing needs them; kitchen_prefs/simulation/kitchen.py has them
// all. Which decisions were refused comes with the data and is not computed here.

const [DOOR, FIRST_DISH, SINK] = [0, 3, 999];
const FIRST_PLACEMENT = { bottom: 1000, top: 2000 };
const RACK_OF = { 1: "bottom", 2: "top" };
const ARRIVALS_AT_LATEST = 30;
const DISH_NUMBERS = 4; // category, x, y, angle

function dishesOf(session) {
  const dishes = [];
  for (let i = 0; i < session.dishes.length; i += DISH_NUMBERS) {
    const [category, x, y, angle] = session.dishes.slice(i, i + DISH_NUMBERS);
    dishes.push({ category, x, y, angle });
  }
  return dishes;
}

function kitchenAtStart(session, dishes) {
  return {
    doorOpen: false,
    out: null,
    held: null,
    moved: null, // the dish that the last decision moved
    places: dishes.map((_, i) => (i < session.present ? "counter" : "to arrive")),
    placements: dishes.map(() => null),
    completed: 0,
    arrived: session.present,
    arriving: false,
  };
}

const rackOfPlacement = (instance) => (instance >= FIRST_PLACEMENT.top ? "top" : "bottom");

/** Carry out a decision that is not refused. */
function carryOut(state, instance) {
  state.moved = null;
  if (state.held === null && instance >= FIRST_DISH) {
    state.held = instance - FIRST_DISH;
    return;
  }
  if (state.held !== null) put(state, instance);
  else if (instance === DOOR) state.doorOpen = !state.doorOpen;
  else state.out = state.out === null ? RACK_OF[instance] : null;
  complete(state);
}

function put(state, instance) {
  const rack = rackOfPlacement(instance);
  state.places[state.held] = instance === SINK ? "sink" : rack;
  if (instance !== SINK) state.placements[state.held] = instance - FIRST_PLACEMENT[rack];
  state.moved = state.held;
  state.held = null;
}

/** After a completed action another dish may arrive. */
function complete(state) {
  state.completed += 1;
  const cleared = state.out === null && !state.places.includes("counter");
  if (cleared || state.completed >= ARRIVALS_AT_LATEST) state.arriving = true;
  if (state.arriving && state.arrived < state.places.length) {
    state.places[state.arrived] = "counter";
    state.arrived += 1;
  }
}

/** What a decision does, before it is carried out. */
function inWords(state, dishes, instance) {
  if (state.held !== null) {
    if (instance === SINK) return "puts it into the sink";
    return `puts it into the ${rackOfPlacement(instance)} rack`;
  }
  if (instance === DOOR) return state.doorOpen ? "closes the door" : "opens the door";
  if (instance in RACK_OF) {
    const rack = RACK_OF[instance];
    return state.out === rack ? `pushes the ${rack} rack in` : `pulls the ${rack} rack out`;
  }
  return `picks a ${data.layout.categories[dishes[instance - FIRST_DISH].category]}`;
}

/** Why a decision is refused. */
function whyRefused(state, instance) {
  if (state.held !== null) return "another dish is in the way";
  if (instance === DOOR) return "a rack is still out";
  if (instance in RACK_OF) return state.doorOpen ? "the other rack is out" : "the door is closed";
  const onCounter = state.places[instance - FIRST_DISH] === "counter";
  return onCounter ? "the grasp fails" : "it is in a rack already";
}

/** The kind of instance that a decision chooses: it colours the timeline. */
function kindOf(dishes, instance) {
  if (instance === SINK) return "sink";
  if (instance >= FIRST_PLACEMENT.bottom) return rackOfPlacement(instance);
  if (instance >= FIRST_DISH) return `pick d${dishes[instance - FIRST_DISH].category}`;
  return "joint";
}

/** The kitchen at the start and after each decision. */
function replay(session, decisions, refusedSteps = []) {
  const dishes = dishesOf(session);
  let state = kitchenAtStart(session, dishes);
  const steps = [{ state, text: "before the first decision", refused: false, kind: "" }];
  decisions.forEach((instance, number) => {
    const refused = refusedSteps.includes(number);
    const text = inWords(state, dishes, instance);
    const reason = refused ? whyRefused(state, instance) : "";
    state = structuredClone(state);
    if (refused) state.moved = null;
    else carryOut(state, instance);
    steps.push({
      state, refused, kind: kindOf(dishes, instance),
      text: refused ? `refused: ${text}; ${reason}` : text,
    });
  });
  return { dishes, steps };
}
