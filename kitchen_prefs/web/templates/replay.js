// Decisions in words and step by step.

/** What a decision does, before it is carried out. */
function inWords(state, instance) {
  if (state.held !== null) {
    if (instance === SINK) return "puts it into the sink";
    return `puts it into the ${rackOfPlacement(instance)} rack`;
  }
  if (instance === DOOR) return state.doorOpen ? "closes the door" : "opens the door";
  if (instance in RACK_OF) {
    const rack = RACK_OF[instance];
    return state.out === rack ? `pushes the ${rack} rack in` : `pulls the ${rack} rack out`;
  }
  return `picks a ${data.layout.categories[state.dishes[instance - FIRST_DISH].category]}`;
}

/** The kind of instance that a decision chooses: it colours the timeline. */
function kindOf(state, instance) {
  if (instance === SINK) return "sink";
  if (instance >= FIRST_PLACEMENT.bottom) return rackOfPlacement(instance);
  if (instance >= FIRST_DISH) return `pick d${state.dishes[instance - FIRST_DISH].category}`;
  return "joint";
}

/** What the kitchen would carry out can still be refused where grasping is noisy. */
const whyRefused = (state, instance) => refusal(state, instance) || "The grasp failed.";

/** The kitchen at the start and after each decision, some of which were refused. */
function replay(session, decisions, refusedSteps) {
  let state = kitchenAtStart(session);
  const steps = [{ state, text: "before the first decision", refused: false, kind: "" }];
  decisions.forEach((instance, number) => {
    const refused = refusedSteps.includes(number);
    const [text, kind] = [inWords(state, instance), kindOf(state, instance)];
    const shown = refused ? `refused: ${text}. ${whyRefused(state, instance)}` : text;
    state = structuredClone(state);
    if (refused) state.moved = null;
    else carryOut(state, instance);
    steps.push({ state, text: shown, refused, kind });
  });
  return steps;
}
