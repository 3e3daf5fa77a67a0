// What can be chosen in a state, and what it is called.

/** What can be chosen now, blocked placements included. */
function choicesIn(state) {
  if (state.held === null) {
    return [DOOR, TOP_RACK, BOTTOM_RACK, ...counterDishes(state).map((i) => FIRST_DISH + i)];
  }
  return [SINK, ...placementsInHand(state).map((one) => FIRST_PLACEMENT[state.out] + one)];
}

/** Where the focus goes when what it was on is gone. */
function nextChoice(state) {
  if (state.held !== null) {
    if (state.out === null) return SINK;
    const [free] = freePlacements(state, state.out, state.dishes[state.held].category);
    return free === undefined ? SINK : FIRST_PLACEMENT[state.out] + free;
  }
  const [dish] = counterDishes(state);
  if (state.out !== null) {
    const rack = state.out === "top" ? TOP_RACK : BOTTOM_RACK;
    return dish === undefined ? rack : FIRST_DISH + dish;
  }
  return state.doorOpen && dish !== undefined ? TOP_RACK : DOOR;
}

/** An instance in the words of a screen reader. */
function nameOf(state, instance) {
  if (instance === DOOR) return state.doorOpen ? "door, open" : "door, closed";
  if (instance === SINK) return "sink";
  if (instance in RACK_OF) {
    return `${RACK_OF[instance]} rack, ${state.out === RACK_OF[instance] ? "out" : "in"}`;
  }
  if (instance < FIRST_PLACEMENT.bottom) {
    return `${data.layout.categories[state.dishes[instance - FIRST_DISH].category]}, on the counter`;
  }
  const placement = instance - FIRST_PLACEMENT[state.out];
  const taken = isBlocked(state, state.out, placement) ? "blocked" : "free";
  const region = regionOf(placement);
  const there = placementsInHand(state).filter((other) => regionOf(other) === region);
  const number = there.length > 1 ? `, ${there.indexOf(placement) + 1} of ${there.length}` : "";
  return `${taken} place, ${region} of the ${state.out} rack${number}`;
}

/** Where in a rack a placement is, in thirds. */
function regionOf(placement) {
  const [, x, y] = data.layout.placements[placement];
  const [wide, deep] = data.layout.rack;
  const third = (share) => Math.min(Math.floor((share + 0.5) * 3), 2);
  return `${["front", "middle", "back"][third(y / deep)]} ${
    ["left", "centre", "right"][third(x / wide)]}`;
}
