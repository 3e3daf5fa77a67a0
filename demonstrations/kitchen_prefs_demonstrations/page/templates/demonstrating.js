// The left side: the visitor decides, and the kitchen answers.

const TIMELINE = 40; // decisions that it shows at least: most demonstrations have fewer

const you = {
  stage: null,
  kitchen: null, // the session whose dishes stand there
  steps: [], // as `replay` gives them: the state at the start and after each decision
  decisions: [], // what the kitchen carried out
  refused: 0,
  shown: [], // finished demonstrations: what TTP is prompted with; `file` once it is saved
};

const yourState = () => you.steps.at(-1).state;

function startDemonstration(kitchen, decisions = [], refused = 0) {
  you.kitchen = kitchen;
  you.decisions = decisions;
  you.steps = replay(kitchen, decisions, []);
  you.refused = refused;
  remember();
  showYou("");
}

/** Begin anew in the same kitchen; what is finished there no longer counts. */
function startAgain() {
  if (isFinished(yourState())) {
    you.shown.pop();
    stopWatching();
  }
  startDemonstration(you.kitchen);
}

/** Carry out the visitor's choice, or say why not. */
function youChoose(instance) {
  if (isFinished(yourState())) return;
  const before = yourState();
  const reason = refusal(before, instance) || whyTooLong();
  if (reason !== "") {
    you.refused += 1;
    showYou(reason, true);
    return;
  }
  const state = structuredClone(before);
  const [text, kind] = [inWords(before, instance), kindOf(before, instance)];
  carryOut(state, instance);
  you.decisions.push(instance);
  you.steps.push({ state, text, kind, refused: false });
  remember();
  if (isFinished(state)) finishDemonstration();
  showYou([text.replace(/^./, (first) => first.toUpperCase()), arrivalIn(before, state)]
    .filter(Boolean).join(". "));
}

/** Why no decision can follow, or an empty string: a prompt has room for so many. */
function whyTooLong() {
  const fits = you.decisions.length < data.most.decisions && rowsRead(you.steps) <= data.most.rows;
  if (fits) return "";
  return "That is more than a policy reads of one demonstration: Undo takes back what was in vain.";
}

/** How many rows a prompt has for the decisions that are taken in these states. */
function rowsRead(steps) {
  for (const step of steps) step.rows ??= observe(step.state, you.kitchen, 0).ids.length;
  return steps.reduce((sum, { rows }) => sum + rows, 0);
}

function undo() {
  if (you.decisions.length === 0 || isFinished(yourState())) return;
  you.decisions.pop();
  you.steps.pop();
  remember();
  const pressed = document.activeElement === byId("undo");
  showYou("Taken back");
  if (pressed && byId("undo").disabled) byId("you").focus();
}

/** Escape puts a dish back that has only been picked, U takes any decision back. */
function takeBack(event) {
  if (event.target instanceof HTMLInputElement) return; // who types a name decides nothing
  if (event.key === "Escape" && yourState().held !== null) undo();
  else if (event.key.toLowerCase() === "u" && !event.ctrlKey && !event.metaKey) undo();
}

function finishDemonstration() {
  const { kitchen: session, decisions, refused } = you;
  you.shown.push({ session, decisions: [...decisions], refused });
  remember();
  byId("kept").textContent = "";
  save(you.shown.slice(-1));
  if (!study.name) startWatching(you.shown.length > 1 ? kitchens.next("load") : ttp.kitchen);
}

function showYou(says, refused = false) {
  const state = yourState();
  you.stage.show(state, "Your kitchen");
  showStep("you", you, says, refused);
  byId("you-hint").textContent = hintFor(state);
  byId("undo").disabled = you.decisions.length === 0 || isFinished(state);
  byId("again").disabled = isFinished(state) && study.name !== null; // one demonstration a day
  byId("keep").hidden = you.shown.length === 0;
  byId("downloads").replaceChildren(...downloadButtons());
}

/** What both sides show of where they are: "you" or "ttp". */
function showStep(side, { kitchen, steps, decisions }, says, refused) {
  const { state } = steps.at(-1);
  showInThree(side, state, kitchen);
  const same = byId(`${side}-says`).textContent === says;
  byId(`${side}-says`).textContent = same ? `${says}\u00a0` : says; // a reader says what changes
  byId(`${side}-says`).classList.toggle("refused", refused);
  byId(`${side}-count`).textContent = countsOf(state, decisions.length);
  byId(`${side}-timeline`).replaceChildren(
    drawTimeline(steps, decisions.length, Math.max(decisions.length, TIMELINE)));
}

/** What arrived with the last action, in words. */
function arrivalIn(before, state) {
  if (state.arrived === before.arrived) return "";
  return `A ${categoryOf(state, state.arrived - 1)} arrives`;
}

const categoryOf = (state, dish) => data.layout.categories[state.dishes[dish].category];

function countsOf(state, decisions) {
  const waiting = state.places.filter((place) => place === "to arrive").length;
  return [`${decisions} decisions`, `${counterDishes(state).length} on the counter`,
    waiting ? `${waiting} to arrive` : ""].filter(Boolean).join(" \u00b7 ");
}

/** What a visitor may do next. */
function hintFor(state) {
  if (isFinished(state)) return hintAtTheEnd();
  if (state.held !== null) return hintWithDish(state);
  if (counterDishes(state).length === 0) {
    if (state.out !== null) {
      return `Push the rack in${allArrived(state) ? "." : ": more dishes will come."}`;
    }
    return "Everything is loaded: close the door.";
  }
  if (!state.doorOpen) return "Open the door: click the bar at the bottom.";
  if (state.out === null) return "Pull out a rack.";
  return "Pick a dish, or push the rack in.";
}

function hintAtTheEnd() {
  if (!study.name) return "Finished. Now watch TTP.";
  const thanks = "Finished. Thank you.";
  return data.saveTo ? thanks : `${thanks} Please download the file and send it back.`;
}

function hintWithDish(state) {
  const dish = categoryOf(state, state.held);
  if (state.out === null) {
    return `No rack is out: the ${dish} can only go into the sink. Undo puts it back.`;
  }
  const free = freePlacements(state, state.out, state.dishes[state.held].category).length;
  if (free > 0) return `Choose a place for the ${dish}: ${free} are free. Or the sink.`;
  return `No place is free for a ${dish} in the ${state.out} rack. Undo puts it back; the sink takes it.`;
}
