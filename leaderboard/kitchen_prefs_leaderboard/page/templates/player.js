const PACE = 700; // milliseconds a step
const player = { policy: null, expert: null, step: 0, last: 0, timer: null };

const chosen = (id) => Number(byId(`player-${id}`).value);
const chosenSplit = () => byId("player-split").value;

function episodeFacts([, forbidden, [score, pe, order], success, bits]) {
  const wrong = data.reasons.filter((_, bit) => bits & (1 << bit));
  return [`Score ${fixed(score)}`, `PE ${fixed(pe)}`, `ED_c ${fixed(order)}`,
    success ? "success" : "no success", `${forbidden.length} forbidden`,
    ...(wrong.length ? [`went wrong: ${wrong.join(", ")}`] : [])].join(" \u00b7 ");
}

/** Which episodes the list of sessions offers, and in which order. */
function filterChoices() {
  const counts = data.entries[chosen("entry")].shortcomings[chosenSplit()];
  const reasons = data.reasons.map((name, i) => [`reason:${i}`, `${name} (${counts[i]})`])
    .filter((_, i) => counts[i] > 0);
  return [["all", "all, in order"], ["worst", "all, lowest Score first"], ...reasons];
}

function sessionChoices() {
  const episodes = data.entries[chosen("entry")].episodes[chosenSplit()];
  const [kind, reason] = byId("player-filter").value.split(":");
  let numbers = episodes.map((_, i) => i);
  if (kind === "worst") numbers.sort((a, b) => episodes[a][2][0] - episodes[b][2][0]);
  if (kind === "reason") numbers = numbers.filter((i) => episodes[i][4] & (1 << reason));
  const { [chosenSplit()]: sessions } = data.sessions;
  return numbers.map((i) => [i,
    `${i}: ${sessions[i].count} dishes a rack, Score ${fixed(episodes[i][2][0], 2)}`]);
}

function chooseSplit() {
  setOptions(byId("player-filter"), filterChoices());
  chooseFilter();
}

function chooseFilter() {
  setOptions(byId("player-session"), sessionChoices());
  openEpisode();
}

/** Open the first of an entry's episodes in which something went wrong. */
function openEpisodes(entry, split, filter) {
  byId("player-entry").value = entry;
  byId("player-split").value = split;
  setOptions(byId("player-filter"), filterChoices());
  byId("player-filter").value = filter;
  setOptions(byId("player-session"), sessionChoices());
  byId("player-session").selectedIndex = 0;
  openEpisode();
  byId("player").focus();
}

function openEpisode() {
  pause();
  const [entry, number] = [data.entries[chosen("entry")], chosen("session")];
  const session = data.sessions[chosenSplit()][number];
  const episode = entry.episodes[chosenSplit()][number];
  player.policy = replay(session, episode[0], episode[1]);
  player.expert = replay(session, session.expert);
  player.last = Math.max(player.policy.steps.length, player.expert.steps.length) - 1;
  byId("wish").textContent = `\u201c${data.preferences[session.preference]}\u201d`;
  byId("episode-facts").textContent = episodeFacts(episode);
  byId("policy-name").textContent = entry.submission.name;
  byId("slider").max = player.last;
  goTo(0);
}

function goTo(step) {
  player.step = Math.min(Math.max(step, 0), player.last);
  byId("slider").value = player.step;
  byId("slider").setAttribute("aria-valuetext", `step ${player.step} of ${player.last}`);
  show("policy", byId("policy-name").textContent);
  show("expert", "The expert");
  if (player.step === player.last) pause();
}

function show(who, name) {
  const { dishes, steps } = player[who];
  const end = steps.length - 1;
  const now = Math.min(player.step, end);
  const { state, text, refused } = steps[now];
  byId(`${who}-step`).textContent = `${now} of ${end}`;
  byId(`${who}-drawing`).replaceChildren(drawKitchen(state, dishes, `${name}: ${text}`));
  byId(`${who}-ribbon`).replaceChildren(drawRibbon(steps, now, player.last));
  byId(`${who}-said`).textContent = player.step > end ? `${text}, and is done` : text;
  byId(`${who}-said`).classList.toggle("refused", refused);
  const counted = (place) => state.places.filter((one) => one === place).length;
  byId(`${who}-where`).textContent = [`top rack ${counted("top")}`,
    `bottom rack ${counted("bottom")}`, `sink ${counted("sink")}`,
    `counter ${counted("counter")}`, `to come ${counted("to come")}`].join(" \u00b7 ");
}

function pause() {
  clearInterval(player.timer);
  player.timer = null;
  byId("play").textContent = "Play";
  byId("policy-said").setAttribute("aria-live", "polite");
}

function playOrPause() {
  if (player.timer !== null) return pause();
  if (player.step === player.last) goTo(0);
  byId("play").textContent = "Pause";
  byId("policy-said").setAttribute("aria-live", "off"); // it would talk without end
  player.timer = setInterval(() => goTo(player.step + 1), PACE);
}

const KEYS = {
  ArrowLeft: () => goTo(player.step - 1),
  ArrowRight: () => goTo(player.step + 1),
  Home: () => goTo(0),
  End: () => goTo(player.last),
};

/** Arrow keys step wherever the focus is in the player; the slider has them already. */
function onKey(event) {
  const modified = event.altKey || event.ctrlKey || event.metaKey || event.shiftKey;
  if (!(event.key in KEYS) || modified || event.target === byId("slider")) return;
  event.preventDefault();
  KEYS[event.key]();
}

function startPlayer() {
  setOptions(byId("player-entry"), entryChoices());
  setOptions(byId("player-split"), SPLITS.map((split) => [split, words(split)]));
  byId("dish-legend").replaceChildren(...dishLegend());
  byId("player-entry").addEventListener("change", chooseSplit);
  byId("player-split").addEventListener("change", chooseSplit);
  byId("player-filter").addEventListener("change", chooseFilter);
  byId("player-session").addEventListener("change", openEpisode);
  byId("slider").addEventListener("input", () => goTo(Number(byId("slider").value)));
  byId("first").addEventListener("click", KEYS.Home);
  byId("back").addEventListener("click", KEYS.ArrowLeft);
  byId("next").addEventListener("click", KEYS.ArrowRight);
  byId("last").addEventListener("click", KEYS.End);
  byId("play").addEventListener("click", playOrPause);
  byId("player").addEventListener("keydown", onKey);
  chooseSplit();
}
