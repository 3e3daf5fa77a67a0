// What becomes of a demonstration: kept for a reload, downloaded, or saved by the serving program.

const FILE_FORMAT = 1; // kitchen_prefs_demonstrations/file_format.py

/** Under which name this tab, and no other, keeps what was shown; each participant has an own one. */
const storeName = () => ["kitchen_prefs demonstration",
  ...(study.name ? [study.name, study.participant, study.day] : [])].join(" ");

/** Keep what was shown so far, so that a reload loses nothing. */
function remember() {
  const named = ({ session, ...rest }) => ({ kitchen: kitchens.nameOf(session), ...rest });
  const kept = JSON.stringify({
    now: named({ session: you.kitchen, decisions: you.decisions, refused: you.refused }),
    shown: you.shown.map(named),
    waiting: ttp.kitchen && kitchens.nameOf(ttp.kitchen),
    turns: kitchens.turns,
  });
  try {
    sessionStorage.setItem(storeName(), kept);
  } catch { /* a browser that keeps nothing: the page works without */ }
}

/** What a reload interrupted; null where that is nothing, or of another page's kitchens. */
function remembered() {
  try {
    const { now, shown, waiting, turns } = JSON.parse(sessionStorage.getItem(storeName()));
    return { now: inItsKitchen(now), shown: shown.map(inItsKitchen), turns,
      waiting: kitchens.named(waiting) };
  } catch {
    return null;
  }
}

/** A demonstration that was kept; an error where its kitchen is not here or refuses it. */
function inItsKitchen({ kitchen, ...rest }) {
  const session = kitchens.named(kitchen);
  const state = kitchenAtStart(session);
  if (rest.decisions.some((instance) => decide(state, instance) !== "")) throw new Error("refused");
  return { session, ...rest };
}

/** A finished demonstration as the file that `kitchen-prefs demonstrations` reads. */
function demonstrationFile({ session, decisions }) {
  const name = byId("user").value.normalize("NFKC").replace(/\s+/g, " ").trim();
  return {
    format: FILE_FORMAT,
    data_version: data.version,
    split: session.split,
    session: session.index,
    salt: session.salt,
    decisions,
    user: study.name || !name ? null : name,
    consent: study.name ? true : byId("may-be-kept").checked,
    study: study.name
      ? { name: study.name, participant: study.participant, day: study.day } : null,
  };
}

/** A button for each finished demonstration. */
function downloadButtons() {
  return you.shown.map((demonstration, number) => {
    const which = you.shown.length > 1 ? ` ${ORDINALS[number] ?? `number ${number + 1}`}` : "";
    const button = html("button", { type: "button" }, `Download${which}`);
    button.addEventListener("click", () => download(demonstration));
    return button;
  });
}

function download(demonstration) {
  if (!byId("user").reportValidity()) return;
  const file = demonstrationFile(demonstration);
  const { user, study: about, session } = file;
  const who = about ? `${about.participant}-day${about.day}` : user ?? "demonstration";
  const name = `${who.replace(/[^\p{L}\p{N}_-]+/gu, "-")}-${session}.json`;
  const text = JSON.stringify(file);
  const address = URL.createObjectURL(new Blob([text], { type: "application/json" }));
  html("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10000); // milliseconds: the browser has read it
  byId("kept").textContent = `Downloaded as ${name}.`;
}

let sent = Promise.resolve(); // one demonstration goes after the other

/** Hand finished demonstrations, or their new name or consent, to the serving program. */
function save(demonstrations) {
  if (!data.saveTo) return;
  for (const one of demonstrations) sent = sent.then(() => send(one));
}

async function send(demonstration) {
  const { file: before } = demonstration;
  try {
    const answer = await fetch(before ? `${data.saveTo}/${before}` : data.saveTo, { method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify(demonstrationFile(demonstration)) });
    const { file, error } = await answer.json();
    demonstration.file = file ?? before;
    remember();
    byId("kept").textContent = answer.ok ? `Saved as ${file}.` : error;
  } catch {
    byId("kept").textContent = "The program that serves this page does not answer; download instead.";
  }
}
