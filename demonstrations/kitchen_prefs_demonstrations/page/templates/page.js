// What happens when: the page's buttons, and where it begins.

function startPage() {
  byId("stages").hidden = true;
  // A browser that cannot read this script, or not draw the page, leaves the sentence there.
  if (!CSS.supports("color", "light-dark(white, black)")) return;
  startTheme(byId("theme"));
  const trouble = troubleWithStudy();
  byId("trouble").textContent = trouble;
  byId("trouble").hidden = trouble === "";
  if (trouble) return;
  byId("stages").hidden = false;
  you.stage = new Stage(byId("you-drawing"), youChoose);
  byId("about-policy").textContent = data.aboutPolicy;
  byId("saves").hidden = !data.saveTo;
  byId("dish-legend").replaceChildren(...dishLegend());
  listen();
  if (study.name) startStudy();
  else begin();
}

function listen() {
  const clicks = {
    undo,
    again: startAgain,
    "other-counter": () => showAnew("show"),
    play,
    step: oneDecision,
    "ttp-other": watchAnother,
    "once-more": () => showAnew("show"),
    "never-shown": neverShown,
  };
  for (const [id, react] of Object.entries(clicks)) byId(id).addEventListener("click", react);
  byId("you").addEventListener("keydown", takeBack);
  for (const id of ["user", "may-be-kept"]) byId(id).addEventListener("change", () => save(you.shown));
}

/** Begin where a reload left off, or with the first kitchen. */
function begin() {
  const before = remembered();
  if (before !== null) Object.assign(kitchens.turns, before.turns);
  showWhatWaits(before?.waiting ?? kitchens.next("load"));
  goOn(before, "show");
  if (you.shown.length) startWatching(ttp.kitchen);
}

/** Go on with what is remembered; with the next kitchen for a use where that is nothing. */
function goOn(before, use) {
  startThree();
  if (before === null) {
    startDemonstration(kitchens.next(use));
    return;
  }
  you.shown = before.shown;
  startDemonstration(before.now.session, before.now.decisions, before.now.refused);
}

/** TTP loads another counter; its buttons vanish, so the focus goes to what stops it. */
function watchAnother() {
  startWatching(kitchens.next("load"));
  byId("play").focus();
}

/** Another kitchen to show in; what was shown so far is kept and read together with it. */
function showAnew(use) {
  pause();
  startDemonstration(kitchens.next(use));
  byId("you").focus();
}

/** Forget what was shown, and show in a kitchen that lacks a kind of dish. */
function neverShown() {
  you.shown = [];
  stopWatching();
  showAnew("incomplete");
  const lacking = kitchens.lacking(you.kitchen).map(plural).join(" and no ");
  byId("you-says").textContent = `Here are no ${lacking}: TTP will meet them for the first time.`;
}

startPage();
