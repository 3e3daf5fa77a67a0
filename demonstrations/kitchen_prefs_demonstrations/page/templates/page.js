// What happens when: the page's buttons, and where it begins.

function startPage() {
  const trouble = troubleWithStudy();
  startTheme(byId("theme"));
  byId("trouble").hidden = !trouble; // a browser that cannot read this script leaves it there
  byId("trouble").textContent = trouble;
  byId("stages").hidden = Boolean(trouble);
  if (trouble) return;
  you.stage = new Stage(byId("you-drawing"), youChoose);
  byId("about-policy").textContent = data.aboutPolicy;
  byId("saves").hidden = !data.saveTo;
  byId("dish-legend").replaceChildren(...dishLegend());
  listen();
  startThree();
  if (study.name) startStudy();
  else begin();
}

function listen() {
  const clicks = {
    undo,
    again: () => startDemonstration(you.kitchen),
    "other-counter": () => showAnew("show"),
    download,
    play,
    step: oneDecision,
    "ttp-other": () => startWatching(kitchens.next("load")),
    "once-more": () => showAnew("show"),
    "never-shown": neverShown,
  };
  for (const [id, react] of Object.entries(clicks)) byId(id).addEventListener("click", react);
  byId("you-drawing").addEventListener("keydown", putBack);
}

/** Begin where a reload left off, or with the first kitchen. */
function begin() {
  showWhatWaits(kitchens.next("load"));
  const before = remembered();
  if (before === null) {
    startDemonstration(kitchens.next("show"));
    return;
  }
  you.shown = before.shown;
  startDemonstration(before.kitchen, before.decisions);
  if (you.shown.length) {
    keepDemonstration();
    startWatching(ttp.kitchen);
  }
}

/** Another kitchen to show in; what was shown so far is kept and read together with it. */
function showAnew(use) {
  pause();
  byId("keep").hidden = true;
  startDemonstration(kitchens.next(use));
  byId("you").focus();
}

/** Forget what was shown, and show in a kitchen that lacks a kind of dish. */
function neverShown() {
  you.shown = [];
  remember();
  showAnew("incomplete");
  const lacking = kitchens.lacking(you.kitchen).map(plural).join(" and no ");
  byId("you-says").textContent = `Here are no ${lacking}: TTP will meet them for the first time.`;
}

startPage();
