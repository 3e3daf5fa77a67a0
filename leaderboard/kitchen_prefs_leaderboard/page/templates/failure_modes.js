/** In how many episodes of a split a failure mode occurs; a click opens them in the viewer. */
function failureModeCell(index, split, mode) {
  const entry = data.entries[index];
  const { splits, failure_modes } = tierOf(entry);
  const times = entry.failure_modes[split][mode];
  if (times === 0) return html("td", { class: "number none" }, "0");
  const share = Math.round((100 * times) / splits[split]);
  const click = () => openEpisodes(index, split, `mode:${mode}`);
  const title = `${times} episodes of ${words(split)}: ${failure_modes[mode]}`;
  const open = isDrawn(entry)
    ? html("button", { type: "button", click, "aria-label": title }, String(times))
    : html("b", { title }, String(times));
  const small = html("small", {}, share ? `${share} %` : "< 1 %");
  const cell = html("td", { class: "number tinted" }, open, small);
  cell.style.setProperty("--share", `${0.4 * share}%`); // the text stays readable on it
  return cell;
}

function drawFailureModes() {
  const index = Number(byId("failure-modes-entry").value);
  const tier = tierOf(data.entries[index]);
  const splits = splitsOf(tier);
  const heads = splits.map((split) => html("th", { scope: "col", class: "number" }, words(split),
    html("small", {}, `of ${tier.splits[split]}`)));
  const rows = tier.failure_modes.map((name, mode) => html("tr", {},
    html("th", { scope: "row" }, name),
    ...splits.map((split) => failureModeCell(index, split, mode))));
  const title = `Failure modes of ${nameOf(index)}`;
  byId("failure-modes-table").replaceChildren(html("table", { class: "failure-modes" },
    html("caption", { class: "unseen" }, title),
    html("thead", {}, html("tr", {}, html("th", { scope: "col" }, "Episodes"), ...heads)),
    html("tbody", {}, ...rows)));
}

function startFailureModes() {
  setOptions(byId("failure-modes-entry"), entryChoices());
  byId("failure-modes-entry").addEventListener("change", drawFailureModes);
  drawFailureModes();
}
