const PACE = 700; // milliseconds a step
const viewer = { policy: [], expert: [], step: 0, last: 0, timer: null };

const chosen = (id) => Number(byId(`viewer-${id}`).value);
const chosenSplit = () => byId("viewer-split").value;

function episodeFacts(entry, [, refused, [score, pe, order], success, bits]) {
  const modes = tierOf(entry).failure_modes.filter((_, bit) => bits & (1 << bit));
  return [`Score ${fixed(score)}`, `PE ${fixed(pe)}`, `ED_c ${fixed(order)}`,
    success ? "success" : "no success", `${refused.length} refused`,
    ...(modes.length ? [`failure modes: ${modes.join(", ")}`] : [])].join(" \u00b7 ");
}

/** Which episodes the list of sessions offers, and in which order. */
function filterChoices() {
  const entry = data.entries[chosen("entry")];
  const counts = entry.failure_modes[chosenSplit()];
  const modes = tierOf(entry).failure_modes.map((name, i) => [`mode:${i}`, `${name} (${counts[i]})`])
    .filter((_, i) => counts[i] > 0);
  return [["all", "all, in order"], ["worst", "all, lowest Score first"], ...modes];
}

function sessionChoices() {
  const episodes = data.entries[chosen("entry")].drawn.episodes[chosenSplit()];
  const [kind, mode] = byId("viewer-filter").value.split(":");
  let numbers = episodes.map((_, i) => i);
  if (kind === "worst") numbers.sort((a, b) => episodes[a][2][0] - episodes[b][2][0]);
  if (kind === "mode") numbers = numbers.filter((i) => episodes[i][4] & (1 << mode));
  const { [chosenSplit()]: sessions } = data.sessions;
  return numbers.map((i) => [i,
    `${i}: ${sessions[i].count} dishes a rack, Score ${fixed(episodes[i][2][0], 2)}`]);
}

function chooseSplit() {
  setOptions(byId("viewer-filter"), filterChoices());
  chooseFilter();
}

function chooseFilter() {
  setOptions(byId("viewer-session"), sessionChoices());
  openEpisode();
}

/** Open the first of an entry's episodes that have a failure mode. */
function openEpisodes(entry, split, filter) {
  byId("viewer-entry").value = entry;
  byId("viewer-split").value = split;
  setOptions(byId("viewer-filter"), filterChoices());
  byId("viewer-filter").value = filter;
  setOptions(byId("viewer-session"), sessionChoices());
  byId("viewer-session").selectedIndex = 0;
  openEpisode();
  byId("viewer").focus();
}

function openEpisode() {
  pause();
  const [entry, number] = [data.entries[chosen("entry")], chosen("session")];
  const session = data.sessions[chosenSplit()][number];
  const episode = entry.drawn.episodes[chosenSplit()][number];
  viewer.policy = replay(session, episode[0], episode[1]);
  viewer.expert = replay(session, session.expert, []);
  viewer.last = Math.max(viewer.policy.length, viewer.expert.length) - 1;
  byId("preference").textContent = `\u201c${data.preferences[session.preference]}\u201d`;
  byId("episode-facts").textContent = episodeFacts(entry, episode);
  byId("policy-name").textContent = entry.submission.name;
  byId("slider").max = viewer.last;
  goTo(0);
}

function goTo(step) {
  viewer.step = Math.min(Math.max(step, 0), viewer.last);
  byId("slider").value = viewer.step;
  byId("slider").setAttribute("aria-valuetext", `step ${viewer.step} of ${viewer.last}`);
  showStep("policy", byId("policy-name").textContent);
  showStep("expert", "The expert");
  if (viewer.step === viewer.last) pause();
}

function showStep(who, name) {
  const steps = viewer[who];
  const end = steps.length - 1;
  const now = Math.min(viewer.step, end);
  const { state, text, refused } = steps[now];
  byId(`${who}-step`).textContent = `${now} of ${end}`;
  byId(`${who}-drawing`).replaceChildren(drawKitchen(state, `${name}: ${text}`));
  byId(`${who}-timeline`).replaceChildren(drawTimeline(steps, now, viewer.last));
  byId(`${who}-decision`).textContent = viewer.step > end ? `${text}; finished` : text;
  byId(`${who}-decision`).classList.toggle("refused", refused);
  const counted = (place) => state.places.filter((one) => one === place).length;
  byId(`${who}-where`).textContent = [`top rack ${counted("top")}`,
    `bottom rack ${counted("bottom")}`, `sink ${counted("sink")}`,
    `counter ${counted("counter")}`, `to arrive ${counted("to arrive")}`].join(" \u00b7 ");
}

function pause() {
  clearInterval(viewer.timer);
  viewer.timer = null;
  byId("play").textContent = "Play";
  byId("policy-decision").setAttribute("aria-live", "polite");
}

function playOrPause() {
  if (viewer.timer !== null) return pause();
  if (viewer.step === viewer.last) goTo(0);
  byId("play").textContent = "Pause";
  byId("policy-decision").setAttribute("aria-live", "off"); // a screen reader would read every step
  viewer.timer = setInterval(() => goTo(viewer.step + 1), PACE);
}

const KEYS = {
  ArrowLeft: () => goTo(viewer.step - 1),
  ArrowRight: () => goTo(viewer.step + 1),
  Home: () => goTo(0),
  End: () => goTo(viewer.last),
};

/** Arrow keys step wherever the focus is in the viewer; the slider has them already. */
function onKey(event) {
  const modified = event.altKey || event.ctrlKey || event.metaKey || event.shiftKey;
  if (!(event.key in KEYS) || modified || event.target === byId("slider")) return;
  event.preventDefault();
  KEYS[event.key]();
}

function startViewer() {
  setOptions(byId("viewer-entry"), entryChoices(isDrawn));
  setOptions(byId("viewer-split"), SPLITS.map((split) => [split, words(split)]));
  byId("dish-legend").replaceChildren(...dishLegend());
  byId("viewer-entry").addEventListener("change", chooseSplit);
  byId("viewer-split").addEventListener("change", chooseSplit);
  byId("viewer-filter").addEventListener("change", chooseFilter);
  byId("viewer-session").addEventListener("change", openEpisode);
  byId("slider").addEventListener("input", () => goTo(Number(byId("slider").value)));
  byId("first").addEventListener("click", KEYS.Home);
  byId("back").addEventListener("click", KEYS.ArrowLeft);
  byId("next").addEventListener("click", KEYS.ArrowRight);
  byId("last").addEventListener("click", KEYS.End);
  byId("play").addEventListener("click", playOrPause);
  byId("viewer").addEventListener("keydown", onKey);
  chooseSplit();
}
