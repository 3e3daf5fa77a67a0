// What demonstrations imply by counting, and how well an episode follows that.
//
// Python has two readings beside this one: `implied_preference.py` looks for the one of the 2 x 7!
// preferences that explains a demonstration, `habits.py` looks for the order that most picks follow.
// Where a demonstration is not consistent the three can differ.

/**
 * The rule read from demonstrations.
 *
 * Returns: for each category the rack that took most of its dishes ("sink" where none did, null
 * where none was shown), and its rank among the categories of its rack, 0 first; `lead`, which says
 * how far the demonstrations show one category before another; and the racks in the order in which
 * they were loaded.
 */
function impliedPreference(demonstrations) {
  const placesOfEach = demonstrations.map(placesIn);
  const places = placesOfEach.flat();
  const categories = [...data.layout.categories.keys()];
  const ofCategory = (category) => places.filter((place) => place.category === category);
  const rackOf = categories.map((category) =>
    mostFrequent(ofCategory(category).map(({ rack }) => rack)));
  const times = categories.map((category) => mean(ofCategory(category).map(({ time }) => time)));
  const lead = leadOf(demonstrations);
  // Categories that never waited together are ordered by time.
  const isBefore = (one, other) => (lead[one][other] || times[other] - times[one]) > 0;
  const rankOf = categories.map((category) => categories.filter((other) =>
    rackOf[other] === rackOf[category] && isBefore(other, category)).length);
  const first = mostFrequent(placesOfEach
    .map((own) => own.find(({ rack }) => rack !== "sink")?.rack ?? null));
  const racks = first === "bottom" ? ["bottom", "top"] : ["top", "bottom"];
  return { rackOf, rankOf, lead, racks };
}

/** For each two categories how many times more the first was picked while the second waited. */
function leadOf(demonstrations) {
  const count = data.layout.categories.length;
  const lead = Array.from({ length: count }, () => new Array(count).fill(0));
  for (const { session, decisions } of demonstrations) {
    const state = kitchenAtStart(session);
    for (const instance of decisions) {
      if (state.held === null && instance >= FIRST_DISH) {
        const { category } = state.dishes[instance - FIRST_DISH];
        const waiting = new Set(counterDishes(state).map((i) => state.dishes[i].category));
        for (const other of waiting) {
          lead[category][other] += 1;
          lead[other][category] -= 1;
        }
      }
      carryOut(state, instance);
    }
  }
  return lead;
}

/** The dishes that a demonstration put away: category, rack or sink, and the time, from 0 to 1. */
function placesIn({ session, decisions }) {
  const places = [];
  const state = kitchenAtStart(session);
  decisions.forEach((instance, number) => {
    if (state.held !== null) {
      const rack = instance === SINK ? "sink" : rackOfPlacement(instance);
      const { category } = state.dishes[state.held];
      places.push({ category, rack, time: number / decisions.length });
    }
    carryOut(state, instance);
  });
  return places;
}

/** The value that occurs most often, a rack before the sink where they tie; null of none. */
function mostFrequent(values) {
  const counted = (value) => values.filter((one) => one === value).length;
  const ranked = [...new Set(values)].sort((one, other) =>
    counted(other) - counted(one) || (one === "sink") - (other === "sink"));
  return ranked[0] ?? null;
}

const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

/**
 * The dishes whose turn it is: those that wait for the rack that is out and that no other waiting
 * category leads.
 *
 * Returns: null where a dish is in hand, no rack is out, or the order of what waits was not shown.
 * Where it was shown of all, this is Turn of kitchen_prefs/envs/episode_simulator.py.
 */
function dishesInTurn(state, { rackOf, lead }) {
  if (state.held !== null || state.out === null) return null;
  const categoryOfDish = (i) => state.dishes[i].category;
  const waiting = counterDishes(state).filter((i) => rackOf[categoryOfDish(i)] === state.out);
  const inTurn = waiting.filter((i) =>
    !waiting.some((other) => lead[categoryOfDish(other)][categoryOfDish(i)] > 0));
  return inTurn.length === waiting.length ? null : inTurn;
}

/** Turn: the share of picks that chose a dish whose turn it was; 1 where there was no choice. */
function orderOf(steps, decisions, preference) {
  const picks = decisions.flatMap((instance, number) => {
    const turn = steps[number + 1].refused ? null : dishesInTurn(steps[number].state, preference);
    return turn === null ? [] : [turn.includes(instance - FIRST_DISH) ? 1 : 0];
  });
  return picks.length ? mean(picks) : 1;
}

/**
 * Packing efficiency: the mean over the racks of the dishes that stand where they should, as a share
 * of those that should. Dishes of a category that was never shown are not counted.
 */
function packingOf(state, { rackOf }) {
  const shares = ["top", "bottom"].map((rack) => {
    const wanted = state.dishes.filter(({ category }) => rackOf[category] === rack).length;
    const standing = state.dishes.filter(({ category }, i) =>
      rackOf[category] === rack && state.places[i] === rack).length;
    return wanted === 0 ? 1 : standing / wanted;
  });
  return mean(shares);
}

const ORDINALS = ["first", "second", "third", "fourth", "fifth", "sixth", "seventh"];
const PLACE_WORDS = { top: "on top", bottom: "at the bottom", sink: "in the sink" };
const plural = (category) => `${data.layout.categories[category]}s`.replace(/sss$/, "sses");

/** One category's part of the rule: "bowls on top, first". */
function ruleFor(category, { rackOf, rankOf }) {
  const rack = rackOf[category];
  if (rack === null) return `${plural(category)}: never shown`;
  const rank = rack === "sink" ? "" : `, ${ORDINALS[rankOf[category]]}`;
  return `${plural(category)} ${PLACE_WORDS[rack]}${rank}`;
}

/** The whole rule as a sentence. */
function ruleInWords(preference) {
  const { rackOf, rankOf, racks } = preference;
  const categories = [...rackOf.keys()];
  const parts = racks.map((rack) => {
    const own = categories.filter((category) => rackOf[category] === rack)
      .sort((one, other) => rankOf[one] - rankOf[other]);
    return own.length ? `${rack} rack: ${own.map(plural).join(", then ")}` : "";
  });
  const sunk = categories.filter((category) => rackOf[category] === "sink").map(plural);
  const never = categories.filter((category) => rackOf[category] === null).map(plural);
  if (sunk.length) parts.push(`in the sink: ${sunk.join(", ")}`);
  if (never.length) parts.push(`never shown: ${never.join(", ")}`);
  return `${parts.filter(Boolean).join("; ").replace(/^./, (first) => first.toUpperCase())}.`;
}
