// The right side: TTP loads another counter as the visitor did, decision by decision.

const DECISIONS_A_DISH = 2; // a pick and a place
const JOINT_DECISIONS = 6; // the door and both racks, open and closed
const LIMIT_FACTOR = 2; // an episode ends at twice what it takes, as in the environment

const ttp = {
  policy: null,
  kitchen: null,
  steps: [], // as `replay` gives them
  decisions: [],
  memory: null, // what the policy keeps of the episode
  preference: null, // the rule that the demonstrations imply
  shownInWords: [], // each demonstration's decisions
  timer: null,
};

const ttpState = () => ttp.steps.at(-1).state;

/** Show the kitchen that TTP will load. */
function showWhatWaits(kitchen) {
  ttp.kitchen = kitchen;
  ttp.steps = replay(kitchen, [], []);
  ttp.decisions = [];
  for (const id of ["by-rule", "by-attention"]) byId(id).textContent = "\u2014";
  byId("ttp-ends").textContent = "";
  byId("score").hidden = true;
  byId("next").hidden = true;
  showTTP("waits for your demonstration");
}

/** What TTP has read no longer counts. */
function stopWatching() {
  pause();
  ttp.memory = null;
  showWhatWaits(ttp.kitchen);
}

/** Prompt TTP with all that was shown and let it begin. */
function startWatching(kitchen) {
  pause();
  ttp.policy ??= new TTP(data.policy);
  ttp.preference = impliedPreference(you.shown);
  ttp.shownInWords = you.shown.map(decisionsInWords);
  ttp.memory = ttp.policy.begin(ttp.policy.readPrompts(you.shown));
  showWhatWaits(kitchen);
  remember();
  showTTP(you.shown.length > 1 ? `has read your ${you.shown.length} demonstrations`
    : "has read your demonstration");
  play();
}

function ttpDecides() {
  const before = ttpState();
  const state = structuredClone(before);
  const seen = observe(before, ttp.kitchen, ttp.decisions.length);
  const { instance, attention } = ttp.policy.decide(ttp.memory, seen);
  const [text, kind] = [inWords(before, instance), kindOf(before, instance)];
  const reason = decide(state, instance);
  ttp.decisions.push(instance);
  ttp.steps.push({ state, text, kind, refused: reason !== "" });
  showFollowing(before, instance, attention);
  showTTP(reason ? `Refused: ${text}. ${reason}` : text, reason !== "");
  if (watchingIsOver()) showScore();
}

/** Whether TTP has finished, or not begun. */
function watchingIsOver() {
  if (ttp.memory === null) return true;
  const state = ttpState();
  const limit = LIMIT_FACTOR * (DECISIONS_A_DISH * state.dishes.length + JOINT_DECISIONS);
  return isFinished(state) || ttp.decisions.length >= limit;
}

function play() {
  if (ttp.timer !== null) return pause();
  if (watchingIsOver()) return undefined;
  byId("play").textContent = "Pause";
  byId("ttp-says").setAttribute("aria-live", "off"); // a screen reader would read every decision
  const next = () => {
    ttpDecides();
    if (watchingIsOver()) pause();
    else ttp.timer = setTimeout(next, Number(byId("speed").value));
  };
  ttp.timer = setTimeout(next, Number(byId("speed").value));
  return undefined;
}

function pause() {
  clearTimeout(ttp.timer);
  ttp.timer = null;
  byId("play").textContent = "Play";
  byId("ttp-says").setAttribute("aria-live", "polite");
}

function oneDecision() {
  pause();
  ttpDecides();
}

function showTTP(says, refused = false) {
  byId("ttp-drawing").replaceChildren(drawKitchen(ttpState(), `TTP: ${says}`));
  showStep("ttp", ttp, says, refused);
  for (const id of ["play", "step"]) byId(id).disabled = watchingIsOver();
}

// What of the visitor a decision follows ----------------------------------------------------------

function showFollowing(state, instance, attention) {
  const kept = follows(state, instance, ttp.preference) ? "" : " \u2013 not kept here";
  byId("by-rule").textContent = ruleBehind(state, instance, ttp.preference) + kept;
  byId("by-attention").textContent = attended(attention);
}

/** The part of the rule that speaks of a decision. */
function ruleBehind(state, instance, preference) {
  const dish = state.held ?? instance - FIRST_DISH;
  if (dish >= 0) return ruleFor(state.dishes[dish].category, preference);
  if (instance === DOOR) return state.doorOpen ? "closes when all is loaded" : "opens the door first";
  const rank = preference.racks.indexOf(RACK_OF[instance]);
  return `the ${RACK_OF[instance]} rack ${["first", "second"][rank]}`;
}

/** Whether a decision keeps to the rule: the dish's rack, its turn, the door at the end. */
function follows(state, instance, preference) {
  if (state.held !== null) {
    const wanted = preference.rackOf[state.dishes[state.held].category];
    return wanted === null || wanted === (instance === SINK ? "sink" : rackOfPlacement(instance));
  }
  if (instance === DOOR) return !state.doorOpen || (counterDishes(state).length === 0 && allArrived(state));
  const turn = instance in RACK_OF ? null : dishesInTurn(state, preference);
  return turn === null || turn.includes(instance - FIRST_DISH);
}

/** Which of the visitor's decisions the network weighs most, like ones together, and how much. */
function attended(attention) {
  const weights = new Map();
  ttp.shownInWords.forEach((decisions, number) => decisions.forEach((words, i) => {
    const weight = attention[number][i] / ttp.shownInWords.length;
    weights.set(words, (weights.get(words) ?? 0) + weight);
  }));
  const [words, weight] = [...weights].sort((one, other) => other[1] - one[1])[0];
  return `${words} (${Math.round(100 * weight)} % of its attention)`;
}

/** Each decision of a demonstration, like ones in the same words: "cups into the top rack". */
function decisionsInWords({ session, decisions }) {
  const steps = replay(session, decisions, []);
  return decisions.map((instance, number) => {
    const { state } = steps[number];
    if (instance === DOOR || instance in RACK_OF) return `you: ${inWords(state, instance)}`;
    const place = state.held === null ? decisions[number + 1] : instance;
    const dish = state.held ?? instance - FIRST_DISH;
    const where = place === SINK ? "into the sink" : `into the ${rackOfPlacement(place)} rack`;
    return `your ${plural(state.dishes[dish].category)} ${where}`;
  });
}

// How well it followed ----------------------------------------------------------------------------

function showScore() {
  pause();
  const demonstration = you.shown.at(-1);
  const steps = replay(demonstration.session, demonstration.decisions, []);
  const unseen = ttpState().dishes.filter(({ category }) => ttp.preference.rackOf[category] === null);
  byId("scores").replaceChildren(
    scoreRow("TTP, this counter", ttp.steps, ttp.decisions),
    scoreRow("You, by your own rule", steps, demonstration.decisions, demonstration.refused));
  byId("score-note").textContent = unseen.length === 0 ? ""
    : `${unseen.length} dishes of kinds that you have never shown are not counted.`;
  byId("your-way").textContent = ruleInWords(ttp.preference);
  byId("score").hidden = false;
  byId("next").hidden = false;
  byId("ttp-ends").textContent = "TTP has finished; how well it followed you is in the table below.";
  const pressed = [byId("play"), byId("step")].includes(document.activeElement);
  if (pressed) byId("ttp-other").focus(); // those two are disabled now
}

function scoreRow(name, steps, decisions, refused = steps.filter((step) => step.refused).length) {
  const numbers = [fixed(packingOf(steps.at(-1).state, ttp.preference), 2),
    fixed(orderOf(steps, decisions, ttp.preference), 2), String(refused)];
  return html("tr", {}, html("th", { scope: "row" }, name),
    ...numbers.map((number) => html("td", { class: "number" }, number)));
}
