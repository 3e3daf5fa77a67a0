// What becomes of a demonstration: kept for a reload, downloaded, or saved by the serving program.

const STORE = "kitchen_prefs demonstration"; // in this tab alone, so that two tabs are two visitors
const FILE_FORMAT = 1; // kitchen_prefs_demonstrations/file_format.py

/** Keep what was shown so far, so that a reload loses nothing. */
function remember() {
  try {
    sessionStorage.setItem(STORE, JSON.stringify({
      kitchen: kitchens.numberOf(you.kitchen),
      decisions: you.decisions,
      shown: you.shown.map(({ session, decisions }) => [kitchens.numberOf(session), decisions]),
    }));
  } catch { /* a browser that keeps nothing: the page works without */ }
}

/** What a reload interrupted, or null. */
function remembered() {
  try {
    const { kitchen, decisions, shown } = JSON.parse(sessionStorage.getItem(STORE));
    if (!decisions.length) return null;
    return { kitchen: kitchens.all[kitchen], decisions,
      shown: shown.map(([number, of]) => ({ session: kitchens.all[number], decisions: of })) };
  } catch {
    return null;
  }
}

/** The last finished demonstration as the file that `kitchen-prefs demonstrations` reads. */
function demonstrationFile() {
  const { session, decisions } = you.shown.at(-1);
  const name = byId("user").value.normalize("NFKC").trim();
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

/** Offer the finished demonstration, and hand it to the program that serves the page. */
function keepDemonstration() {
  byId("keep").hidden = false;
  byId("kept").textContent = "";
  if (data.saveTo) save();
}

function download() {
  const { user, study: about, session } = demonstrationFile();
  const who = about ? `${about.participant}-day${about.day}` : user ?? "demonstration";
  const name = `${who.replace(/[^\p{L}\p{N}_-]+/gu, "-")}-${session}.json`;
  const text = JSON.stringify(demonstrationFile());
  const address = URL.createObjectURL(new Blob([text], { type: "application/json" }));
  html("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10000); // milliseconds: the browser has read it
  byId("kept").textContent = `Downloaded as ${name}.`;
}

async function save() {
  try {
    const answer = await fetch(data.saveTo, { method: "POST",
      headers: { "Content-Type": "application/json" }, body: JSON.stringify(demonstrationFile()) });
    const { file, error } = await answer.json();
    byId("kept").textContent = answer.ok ? `Saved as ${file}.` : error;
  } catch {
    byId("kept").textContent = "The program that serves this page does not answer; download instead.";
  }
}
