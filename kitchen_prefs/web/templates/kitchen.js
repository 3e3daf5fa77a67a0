// The kitchen's rules, as in kitchen_prefs/simulation/kitchen.py. A state is plain data, so that
// structuredClone copies it.

const [DOOR, BOTTOM_RACK, TOP_RACK, FIRST_DISH, SINK] = [0, 1, 2, 3, 999];
const FIRST_PLACEMENT = { bottom: 1000, top: 2000 };
const RACK_OF = { [BOTTOM_RACK]: "bottom", [TOP_RACK]: "top" };
const ARRIVALS_AT_LATEST = 30; // completed actions
const DISH_NUMBERS = 4; // category, x, y, angle
const CATEGORY_OF_PLACEMENT = data.layout.placements.map(([category]) => category);
const BLOCKS = bytesOf(data.layout.blocks);

/** The dishes of a session, in the order in which they arrive. */
function dishesOf(session) {
  const dishes = [];
  for (let i = 0; i < session.dishes.length; i += DISH_NUMBERS) {
    const [category, x, y, angle] = session.dishes.slice(i, i + DISH_NUMBERS);
    dishes.push({ category, x, y, angle });
  }
  return dishes;
}

/** A session's kitchen before the first decision. */
function kitchenAtStart(session) {
  const dishes = dishesOf(session);
  return {
    dishes,
    doorOpen: false,
    out: null, // the rack that is pulled out
    held: null, // the dish in hand; it stays where it was picked until it is placed
    moved: null, // the dish that the last decision moved
    places: dishes.map((_, i) => (i < session.present ? "counter" : "to arrive")),
    placements: dishes.map(() => null),
    completed: 0, // actions: toggles and finished places
    arrived: session.present,
    arriving: false,
  };
}

// What is visible ---------------------------------------------------------------------------------

const dishesAt = (state, place) =>
  [...state.places.keys()].filter((i) => state.places[i] === place);

/** The dishes on the counter, the one in hand included. */
const counterDishes = (state) => dishesAt(state, "counter");

/** The dishes on the counter or in the rack that is out. */
function visibleDishes(state) {
  return [...state.places.keys()].filter((i) =>
    state.places[i] === "counter" || (state.out !== null && state.places[i] === state.out));
}

const placementsOf = (category) =>
  [...CATEGORY_OF_PLACEMENT.keys()].filter((one) => CATEGORY_OF_PLACEMENT[one] === category);

/** The placements of the category in hand in the rack that is out, free or not. */
function placementsInHand(state) {
  if (state.held === null || state.out === null) return [];
  return placementsOf(state.dishes[state.held].category);
}

/** Whether the dish of one placement stands in the way of another one's. */
function blocks(placement, other) {
  const bit = placement * CATEGORY_OF_PLACEMENT.length + other;
  return (BLOCKS[bit >> 3] & (128 >> (bit & 7))) !== 0;
}

/** Whether a dish in the rack blocks a placement. */
function isBlocked(state, rack, placement) {
  return dishesAt(state, rack).some((dish) => blocks(state.placements[dish], placement));
}

/** The placements of a category that no dish in the rack blocks. */
function freePlacements(state, rack, category) {
  return placementsOf(category).filter((placement) => !isBlocked(state, rack, placement));
}

const allArrived = (state) => state.arrived === state.places.length;

/** Whether both racks are in and the door is closed. */
const isClosed = (state) => state.out === null && !state.doorOpen;

/** Whether everything has arrived, the counter is empty and everything is closed. */
function isFinished(state) {
  return isClosed(state) && allArrived(state) && !state.places.includes("counter");
}

// What a decision changes -------------------------------------------------------------------------

/** Carry out one decision, or return why it could not be carried out; then nothing changes. */
function decide(state, instance) {
  const reason = refusal(state, instance);
  if (reason === "") carryOut(state, instance);
  return reason;
}

/** Why a decision cannot be carried out now, or an empty string. */
function refusal(state, instance) {
  if (state.held !== null) return refusalOfPlace(state, instance);
  if (instance === DOOR) return state.out === null ? "" : "The door moves only with both racks in.";
  if (instance in RACK_OF) return refusalOfRack(state, RACK_OF[instance]);
  if (state.places[instance - FIRST_DISH] === "counter") return "";
  return "Only a dish on the counter can be picked; one in a rack stays there.";
}

function refusalOfRack(state, rack) {
  if (!state.doorOpen) return "A rack moves only with the door open.";
  if (state.out !== null && state.out !== rack) return "A rack moves only with the other rack in.";
  return "";
}

function refusalOfPlace(state, instance) {
  if (instance === SINK) return "";
  const placement = instance - FIRST_PLACEMENT[state.out];
  if (!placementsInHand(state).includes(placement)) {
    return "A dish goes only into a placement of its category in the rack that is out.";
  }
  if (isBlocked(state, state.out, placement)) {
    return "The placement is blocked by a dish in the rack.";
  }
  return "";
}

function carryOut(state, instance) {
  state.moved = null;
  if (state.held === null && instance >= FIRST_DISH) {
    state.held = instance - FIRST_DISH;
    return;
  }
  if (state.held !== null) put(state, instance);
  else if (instance === DOOR) state.doorOpen = !state.doorOpen;
  else state.out = state.out === null ? RACK_OF[instance] : null;
  completeAction(state);
}

function put(state, instance) {
  const rack = rackOfPlacement(instance);
  state.places[state.held] = instance === SINK ? "sink" : rack;
  if (instance !== SINK) state.placements[state.held] = instance - FIRST_PLACEMENT[rack];
  state.moved = state.held;
  state.held = null;
}

const rackOfPlacement = (instance) => (instance >= FIRST_PLACEMENT.top ? "top" : "bottom");

/** After a completed action another dish may arrive. */
function completeAction(state) {
  state.completed += 1;
  const cleared = state.out === null && !state.places.includes("counter");
  if (cleared || state.completed >= ARRIVALS_AT_LATEST) state.arriving = true;
  if (state.arriving && !allArrived(state)) {
    state.places[state.arrived] = "counter";
    state.arrived += 1;
  }
}
